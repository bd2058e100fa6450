#pragma once
// What a robot decides: readings in, twist out. The simulation calls it in process, a client over UDP calls the same
// code.

#include <cstdint>
#include <span>

#include "base/pose.h"
#include "base/reading.h"
#include "base/report.h"

namespace sf::control {

/// All a robot knows at one time. Spans live for the call.
struct Input {
  std::int64_t time = 0;  ///< [ns] simulated, or the clock of the robot; never runs backwards
  base::Report state;     ///< its own state as it knows it
  std::span<const base::ReadingBlock>
      readings;          ///< its own newest readings, new since the last call or not; may be empty
  bool contact = false;  ///< its bumper: something refused its last motion
};

/// One per robot. One thread at a time for each; different robots' controllers may run side by side.
class Controller {
 public:
  virtual ~Controller() = default;
  /// @return what the robot should do until the next call; finite
  virtual base::Twist step(const Input& input) = 0;
};

}  // namespace sf::control
