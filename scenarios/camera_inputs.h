#pragma once
// Poses that overhead cameras measure ([positioning]) as inputs `camera` of derived sensors. A robot that localizes
// itself receives the same poses.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "base/report.h"
#include "farm/farm.h"
#include "scenarios/positioning.h"

namespace sf::scenarios {

class CameraInputs {
 public:
  /// Adds the movers with such an input that it does not have yet.
  void add(const farm::Farm& farm, const world::World& world, const PositioningOptions& options);
  bool empty() const { return robots_.empty(); }

  /// Measures the poses that are due and returns those received by `time` [ns]. Called at each tick.
  /// @param states per mover; absent ones are not measured @return valid until the next call
  std::span<const base::ReadingBlock> receive(std::int64_t time, std::span<const base::Report> states,
                                              const std::vector<bool>& absent);

 private:
  struct Robot {
    std::uint32_t mover = 0;
    Positioning positioning;
    std::uint32_t received = 0;  ///< number of poses
  };
  std::vector<Robot> robots_;
  std::vector<std::array<double, 10>> values_;  ///< of one tick: pose, valid, covariance
  std::vector<base::ReadingBlock> readings_;
};

}  // namespace sf::scenarios
