#pragma once
// The thesis' common control logic (figure 29), around every controller:
//
//   Start --(at once, or the start signal)--> Control <--(bumper released / pressed)--> Wait
//                                             Control --(the controller is done)--> Stop
//
// Settings: `start`, "at-once" or "signal"; `wait_on_bumper`, default `ControllerType::stops_on_bumper`; `localize`:
// the controller receives the state estimated from the robot's own sensors; `monitor`: without faulty ones.

#include <memory>
#include <optional>

#include "control/controllers.h"
#include "control/own_localization.h"
#include "control/shared_map.h"
#include "control/stop_reason.h"

namespace sf::control {

enum class ControlShellState { start, control, wait, stop };

/// Settings of the shell.
struct ControlShellSettings {
  bool on_signal = false;      ///< Start lasts until `ControllerInput::started`
  bool wait_on_bumper = true;  ///< Control becomes Wait while `ControllerInput::contact`
  /// Replaces `ControllerInput::state` with estimates, in every state of the shell; nullopt: not set.
  std::optional<bool> localize;
  bool monitor = false;  ///< it monitors the sensors by which it localizes itself
};

/// @throws base::InputError for an unknown value of `start`
ControlShellSettings read_control_shell_settings(Settings& settings, bool stops_on_bumper);

class ControlShell final : public Controller, public StatesStopReason, public SharesMap {
 public:
  /// @param inner not null
  ControlShell(std::unique_ptr<Controller> inner, const ControlShellSettings& settings,
               std::optional<OwnLocalization> localization = std::nullopt);

  /// Returns a zero twist in Start, Wait and Stop, and while the robot is lost. Does not call the inner controller in
  /// these states, so its time jumps over a Wait.
  base::Twist step(const ControllerInput& given) override;

  base::Intent intent() const override { return inner_->intent(); }
  double v2v_range() const override { return inner_->v2v_range(); }
  std::uint8_t outputs() const override { return inner_->outputs(); }
  std::uint64_t needs() const override { return inner_->needs(); }
  const maps::OccupancyGrid* own_map() const override { return inner_->own_map(); }
  bool done() const override { return state_ == ControlShellState::stop; }
  /// Returns NaN after steps in which the inner controller was not called.
  double error() const override;
  std::string stop_reason() const override;
  std::shared_ptr<const SharedMap> shared_map() const override { return sharing_->shared_map(); }
  void receive_maps(std::span<const TeammateMap> maps) override { sharing_->receive_maps(maps); }
  bool shares_map() const override { return sharing_ != nullptr && sharing_->shares_map(); }

  ControlShellState state() const { return state_; }
  const Controller& inner() const { return *inner_; }
  Controller& inner() { return *inner_; }
  const OwnLocalization* localization() const { return localization_ ? &*localization_ : nullptr; }

 private:
  void change(const ControllerInput& input);

  std::unique_ptr<Controller> inner_;
  SharesMap* sharing_;  ///< the inner controller; null: it does not share maps
  ControlShellSettings settings_;
  std::optional<OwnLocalization> localization_;  ///< nullopt: the state of the input is used
  ControlShellState state_ = ControlShellState::start;
  bool stepped_ = false;  ///< the last step called the inner controller
};

}  // namespace sf::control
