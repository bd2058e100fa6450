#pragma once
// Wanders without a map: drives where there is room, slows down near obstacles, turns to the freer side before contact,
// and after a contact backs off and turns by a random angle. Drives forward if touched only from behind. Works with any
// laser, several, or none.
//
// With `check_sweep` it executes only commands whose swept area is free (control/swept_area.h): it slows down, turns to
// the other side, backs off or stops instead.

#include <cstdint>
#include <optional>

#include "control/clearance_estimator.h"
#include "control/controllers.h"
#include "control/swept_area.h"
#include "world/world.h"

namespace sf::control {

/// Distances [m] from the body's front, derived from the mover's dimensions and limits.
struct WanderSettings {
  double speed = 0.4;   ///< [m/s] on free ground
  double turn = 1.0;    ///< [rad/s] when blocked
  double stop = 0.15;   ///< a nearer obstacle starts a turn
  double resume = 0.3;  ///< a turn ends at this free distance; > stop
  double slow = 0.8;    ///< a nearer obstacle reduces the speed; > resume
  bool turns_in_place = true;
};

WanderSettings wander_settings(const world::Mover& mover, double range);

class Wander final : public Controller {
 public:
  /// @param robot row of the mover; selects the robot's random numbers
  /// @param speed [m/s] on free ground; nullopt: the speed of `wander_settings`
  /// @param swept_area checks commands; nullopt: executes them unchecked
  Wander(const world::Mover& mover, std::span<const sensors::SensorSpec> lasers, std::uint32_t robot,
         std::uint64_t seed, std::optional<double> speed = {}, std::optional<SweptArea> swept_area = {});

  /// Depends only on the inputs so far and on (seed, robot).
  base::Twist step(const ControllerInput& input) override;
  std::uint64_t needs() const override { return contacts_suffice_ ? 0 : kNeedsFarm; }
  double v2v_range() const override { return swept_area_ ? swept_area_->v2v_range() : 0.0; }

 private:
  enum class Mode { cruise, turn, back };
  double random();
  void choose(const ControllerInput& input, const Clearance& clearance);
  void drive_away(const Clearance& clearance);
  void start_turn(const Clearance& clearance, double least);
  void start_back(std::int64_t time);
  base::Twist drive(const Clearance& clearance, std::int64_t time);
  base::Twist cruise(const Clearance& clearance, std::int64_t time);
  base::Twist turn() const;
  base::Twist checked(const base::Twist& wanted, const base::Report& state, const Clearance& clearance);

  ClearanceEstimator clearance_estimator_;
  std::optional<SweptArea> swept_area_;
  WanderSettings settings_;
  std::uint32_t robot_;
  std::uint64_t seed_;
  bool contacts_suffice_;  ///< no laser
  std::uint64_t draws_ = 0;
  Mode mode_ = Mode::cruise;
  double side_ = 1.0;             ///< +1 turns left, -1 right
  double least_ = 0.0;            ///< [rad] minimum angle of the current turn
  double turned_ = 0.0;           ///< [rad] since the turn began
  double last_yaw_ = 0.0;         ///< [rad]
  std::int64_t until_ = 0;        ///< [ns] end of backing off
  std::int64_t drift_until_ = 0;  ///< [ns]
  double drift_ = 0.0;            ///< [rad/s] slow random turn while cruising
};

extern const ControllerType wander_controller;

}  // namespace sf::control
