#pragma once
// Reason for a robot's standstill.

#include <string>

namespace sf::control {

class Controller;

/// Interface of controllers that state why they have stopped.
class StatesStopReason {
 public:
  /// Returns the reason at the last step, such as "its lane edge sensor sees nothing to follow"; empty while the robot
  /// drives or if no reason is known.
  virtual std::string stop_reason() const = 0;

 protected:
  ~StatesStopReason() = default;
};

/// Returns the controller's stop reason; empty for controllers without this interface.
std::string stop_reason_of(const Controller& controller);

}  // namespace sf::control
