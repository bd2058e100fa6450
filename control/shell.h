#pragma once
// The thesis' common control logic (figure 29), around every controller:
//
//   Start --(at once, or the start signal)--> Control <--(bumper released / pressed)--> Wait
//                                             Control --(the controller is done)--> Stop
//
// Settings: `start` "at-once" or "signal"; `wait_on_bumper`, unless given what the kind says (`ControllerKind::waits`).

#include <memory>

#include "control/controllers.h"
#include "control/reason.h"

namespace sf::control {

enum class ShellState { start, control, wait, stop };

/// What the user said of the shell.
struct ShellSettings {
  bool on_signal = false;      ///< Start lasts until `Input::started`
  bool wait_on_bumper = true;  ///< Control becomes Wait while `Input::contact`
};

/// @throws base::InputError for a word that is no way to start.
ShellSettings read_shell_settings(Settings& settings, bool waits);

class Shell final : public Controller, public StatesReason {
 public:
  /// @param inner not null
  Shell(std::unique_ptr<Controller> inner, const ShellSettings& settings);

  /// Stands in Start, Wait and Stop; the controller within is not called there, and so sees time jump over a Wait.
  base::Twist step(const Input& input) override;

  base::Intent intent() const override { return inner_->intent(); }
  double radio() const override { return inner_->radio(); }
  bool done() const override { return state_ == ShellState::stop; }
  /// Not a number after steps in which the controller was not called.
  double error() const override;
  std::string reason() const override;

  ShellState state() const { return state_; }
  const Controller& inner() const { return *inner_; }

 private:
  void change(const Input& input);

  std::unique_ptr<Controller> inner_;
  ShellSettings settings_;
  ShellState state_ = ShellState::start;
  bool stepped_ = false;  ///< by the last step
};

}  // namespace sf::control
