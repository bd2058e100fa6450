#pragma once
// The thesis' common control logic (figure 29), around every controller:
//
//   Start --(at once, or the start signal)--> Control <--(bumper released / pressed)--> Wait
//                                             Control --(the controller is done)--> Stop
//
// Settings: `start` "at-once" or "signal"; `wait_on_bumper`, unless given what the kind says
// (`ControllerType::stops_on_bumper`).

#include <memory>

#include "control/controllers.h"
#include "control/stop_reason.h"

namespace sf::control {

enum class ControlShellState { start, control, wait, stop };

/// What the user said of the shell.
struct ControlShellSettings {
  bool on_signal = false;      ///< Start lasts until `Input::started`
  bool wait_on_bumper = true;  ///< Control becomes Wait while `Input::contact`
};

/// @throws base::InputError for a word that is no way to start.
ControlShellSettings read_control_shell_settings(Settings& settings, bool stops_on_bumper);

class ControlShell final : public Controller, public StatesStopReason {
 public:
  /// @param inner not null
  ControlShell(std::unique_ptr<Controller> inner, const ControlShellSettings& settings);

  /// Stands in Start, Wait and Stop; the controller within is not called there, and so sees time jump over a Wait.
  base::Twist step(const ControllerInput& input) override;

  base::Intent intent() const override { return inner_->intent(); }
  double v2v_range() const override { return inner_->v2v_range(); }
  bool done() const override { return state_ == ControlShellState::stop; }
  /// Not a number after steps in which the controller was not called.
  double error() const override;
  std::string stop_reason() const override;

  ControlShellState state() const { return state_; }
  const Controller& inner() const { return *inner_; }

 private:
  void change(const ControllerInput& input);

  std::unique_ptr<Controller> inner_;
  ControlShellSettings settings_;
  ControlShellState state_ = ControlShellState::start;
  bool stepped_ = false;  ///< by the last step
};

}  // namespace sf::control
