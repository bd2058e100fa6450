#pragma once
// Why a robot stands.

#include <string>

namespace sf::control {

class Controller;

/// Of a controller that can state it.
class StatesStopReason {
 public:
  /// After its last step, such as "its lane edge sensor sees nothing to follow"; empty: it drives, or has none to
  /// state.
  virtual std::string stop_reason() const = 0;

 protected:
  ~StatesStopReason() = default;
};

/// The reason that the controller states; empty where it cannot.
std::string stop_reason_of(const Controller& controller);

}  // namespace sf::control
