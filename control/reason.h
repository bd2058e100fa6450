#pragma once
// Why a robot stands.

#include <string>

namespace sf::control {

class Controller;

/// Of a controller that can state it.
class StatesReason {
 public:
  /// After its last step, such as "its lane edge sensor sees nothing to follow"; empty: it drives, or has none to
  /// state.
  virtual std::string reason() const = 0;

 protected:
  ~StatesReason() = default;
};

/// The reason that the controller states; empty where it cannot.
std::string reason_of(const Controller& controller);

}  // namespace sf::control
