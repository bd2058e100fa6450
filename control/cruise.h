#pragma once
// Keeps to one lane of a road network at full size and at a constant speed, slower in bends and behind other robots. A
// lane with an exit to its own start is driven again and again; on others it stops at the end.

#include <vector>

#include "control/controllers.h"
#include "control/stop_reason.h"
#include "world/roads/curve.h"

namespace sf::control {

struct CruiseSettings {
  double speed = 10.0;    ///< [m/s] > 0 on a free road
  double headway = 1.5;   ///< [s] > 0 to the robot ahead
  double gap = 6.0;       ///< [m] >= 0 between the origins of both robots at a standstill
  double sideways = 2.5;  ///< [m/s^2] > 0 in bends
  double preview = 0.8;   ///< [s] > 0 time in which it returns to its line
  double range = 80.0;    ///< [m] of V2V reception
};

class Cruise final : public Controller, public StatesStopReason {
 public:
  /// @param lane with a direction @param closed its end leads to its start
  Cruise(const world::RoadLane& lane, bool closed, CruiseSettings settings);

  base::Twist step(const ControllerInput& input) override;
  double v2v_range() const override { return settings_.range; }
  bool done() const override { return done_; }
  double error() const override { return offset_; }  ///< [m] to the left of the line
  std::string stop_reason() const override { return stop_reason_; }
  std::uint64_t needs() const override { return 0; }

 private:
  double curvature_at(double s) const;
  double ahead(double s, double of) const;
  double speed_behind(const ControllerInput& input, const world::CurvePlace& here) const;

  std::vector<glm::dvec2> points_;  ///< the first one again at the end of a closed lane
  std::vector<double> s_;           ///< [m] along the lane, per point
  bool closed_;
  double half_width_;  ///< [m] of the lane
  CruiseSettings settings_;
  double offset_ = 0.0;
  bool done_ = false;
  const char* stop_reason_ = "";
};

extern const ControllerType cruise_controller;

}  // namespace sf::control
