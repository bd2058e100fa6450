#pragma once
// Remote control: drives by commands from outside its process (DRIVE packets of its farm, docs/packets.md) and stops
// when they cease.

#include <cstdint>
#include <optional>

#include "control/controllers.h"

namespace sf::control {

class Remote final : public Controller {
 public:
  /// @param timeout [ns] > 0 after which a command no longer applies
  explicit Remote(std::int64_t timeout) : timeout_(timeout) {}

  /// Sets the command from `time` [ns] on, of the same clock as `ControllerInput::time`. @param twist finite
  void command(const base::Twist& twist, std::int64_t time) { command_ = twist, time_ = time; }
  /// Returns a zero twist without a command, or when the last one is older than the timeout.
  base::Twist step(const ControllerInput& input) override;
  std::uint64_t needs() const override { return 0; }

 private:
  std::int64_t timeout_;
  std::optional<base::Twist> command_;
  std::int64_t time_ = 0;  ///< [ns] of the command
};

/// Returns the remote control within `controller`, as made by `make_controller`; null: it is another controller.
Remote* remote_of(Controller& controller);

extern const ControllerType remote_controller;

}  // namespace sf::control
