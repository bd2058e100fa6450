#pragma once
// What a robot decides: readings in, twist out. The simulation calls it in process, a robot of its own over UDP calls
// the same code.

#include <cstdint>
#include <limits>
#include <span>

#include "base/pose.h"
#include "base/reading.h"
#include "base/report.h"
#include "world/lights.h"

namespace sf::control {

/// Another robot, as it tells of itself (V2V).
struct Neighbour {
  std::uint32_t id = 0;  ///< on the wire
  base::Report state;    ///< `mover` is not to be relied on
  base::Intent intent;
};

/// All a robot knows at one time. Spans live for the call.
struct ControllerInput {
  std::int64_t time = 0;  ///< [ns] simulated, or the clock of the robot; never runs backwards
  base::Report state;     ///< its own state as it knows it
  std::span<const base::ReadingBlock>
      readings;          ///< the newest of each of its own sensors, new since the last call or not; may be empty
  bool contact = false;  ///< its bumper is pressed, or something refused its last motion
  bool started = true;   ///< the start signal was given
  std::span<const Neighbour> others;         ///< robots within `Controller::v2v_range`, by id
  std::span<const world::Signal> signals{};  ///< one per row of `World::lights`
};

/// One per robot. One thread at a time for each; different robots' controllers may run side by side.
class Controller {
 public:
  virtual ~Controller() = default;
  /// @return what the robot should do until the next call; finite
  virtual base::Twist step(const ControllerInput& input) = 0;

  /// What it tells others, after a step.
  virtual base::Intent intent() const { return {}; }
  /// How far it wants to hear others. [m] 0: not at all
  virtual double v2v_range() const { return 0.0; }
  /// It has done what it was made for, and stands.
  virtual bool done() const { return false; }
  /// The control error of the last step, in its own unit; not a number where there was none: for statistics.
  virtual double error() const { return std::numeric_limits<double>::quiet_NaN(); }
};

/// The newest reading of one sensor; null where there is none.
inline const base::ReadingBlock* newest(const ControllerInput& input, std::uint8_t kind, std::uint32_t sensor = 0) {
  for (const base::ReadingBlock& reading : input.readings)
    if (reading.kind == kind && reading.sensor == sensor) return &reading;
  return nullptr;
}

}  // namespace sf::control
