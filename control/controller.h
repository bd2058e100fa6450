#pragma once
// Interface of robot controllers: readings in, twist out. The simulation calls a controller in process; `sensorfarm
// robot` runs the same code over UDP. For the list of controllers, their names and settings see control/controllers.h.

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "base/pose.h"
#include "base/reading.h"
#include "base/report.h"
#include "base/state_quality.h"
#include "world/lights.h"

namespace sf::maps {
struct OccupancyGrid;
}
namespace sf::world {
struct RoadNetwork;
}

namespace sf::control {

/// Another robot's state from its V2V packet.
struct Neighbour {
  std::uint32_t id = 0;  ///< id in packets
  base::Report state;    ///< ignore its `mover`
  base::Intent intent;
  base::StateQuality quality = {};  ///< of `state`, as the robot estimates it; not stated: unknown, or the true state
};

/// The robot's pose as measured by a positioning system.
struct MeasuredPose {
  std::int64_t time = 0;               ///< [ns] of the measurement
  base::Pose X_WM;                     ///< finite
  std::array<double, 6> covariance{};  ///< xx, xy, x yaw, yy, y yaw, yaw yaw [m^2, m rad, rad^2], positive definite
};

/// Inputs of one control step. Spans are valid during the call.
struct ControllerInput {
  std::int64_t time = 0;  ///< [ns] simulated time, or the robot's clock; does not decrease
  base::Report state;     ///< the robot's own state: true in a simulation, that of its motion model in `robot`, and
                          ///< with the setting `localize` the estimate from its own sensors
  /// The newest reading of each of its sensors, whether or not it is new since the last call; may be empty.
  std::span<const base::ReadingBlock> readings;
  bool contact = false;                      ///< the bumper is pressed, or an obstacle blocked the last motion
  bool started = true;                       ///< the start signal was given
  std::span<const Neighbour> others;         ///< robots within `Controller::v2v_range`, in order of id
  std::span<const world::Signal> signals{};  ///< one per row of `World::lights`
  /// Roads with the current uses of their lanes (world/roads/lane_use.h); null: as at the start.
  std::shared_ptr<const world::RoadNetwork> roads{};
  /// Arrived since the last call, for the estimate of its own state; may be late and out of order.
  std::span<const MeasuredPose> poses = {};
};

/// One object per robot. Calls on one object are made by one thread at a time; different objects may run in parallel.
class Controller {
 public:
  /// `needs` of controllers that never drive without the farm's readings.
  static constexpr std::uint64_t kNeedsFarm = ~std::uint64_t{0};

  virtual ~Controller() = default;
  /// @return the twist to drive until the next call; finite
  virtual base::Twist step(const ControllerInput& input) = 0;

  /// Returns the intent to broadcast (V2V), after a step.
  virtual base::Intent intent() const { return {}; }
  /// Returns the radius [m] within which states of other robots are needed; 0: none.
  virtual double v2v_range() const { return 0.0; }
  /// Returns whether the task is finished and the robot has stopped.
  virtual bool done() const { return false; }
  /// Returns the control error of the last step, in the controller's own unit, for statistics; NaN without an error.
  virtual double error() const { return std::numeric_limits<double>::quiet_NaN(); }
  /// Returns the digital outputs that a real robot with such pins sets after a step, by bit (docs/robots.md).
  virtual std::uint8_t outputs() const { return 0; }
  /// Returns the sensor types by wire id, as bits, of which readings of any one suffice to drive; 0: it needs no
  /// readings. A robot drives on with those of its own sensors while the farm is away. Read once.
  virtual std::uint64_t needs() const { return kNeedsFarm; }
  /// Returns the map that the robot drives by, valid until the next step; null: it keeps none.
  virtual const maps::OccupancyGrid* own_map() const { return nullptr; }
};

/// Returns the newest reading of one sensor; null if there is none.
inline const base::ReadingBlock* newest(const ControllerInput& input, std::uint8_t type, std::uint32_t sensor = 0) {
  for (const base::ReadingBlock& reading : input.readings)
    if (reading.type == type && reading.sensor == sensor) return &reading;
  return nullptr;
}

}  // namespace sf::control
