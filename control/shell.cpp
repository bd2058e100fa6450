#include "control/shell.h"

#include <utility>

#include "base/error.h"

namespace sf::control {

ShellSettings read_shell_settings(Settings& settings, bool waits) {
  ShellSettings read;
  read.on_signal = settings.choice("start", "at-once", {"at-once", "signal"}) == "signal";
  read.wait_on_bumper = settings.flag("wait_on_bumper", waits);
  return read;
}

Shell::Shell(std::unique_ptr<Controller> inner, const ShellSettings& settings)
    : inner_(std::move(inner)), settings_(settings) {
  SF_CHECK(inner_ != nullptr, "a shell without a controller");
}

base::Twist Shell::step(const Input& input) {
  change(input);
  stepped_ = state_ == ShellState::control;
  if (!stepped_) return {};
  const base::Twist twist = inner_->step(input);
  if (!inner_->done()) return twist;
  state_ = ShellState::stop;
  return {};
}

double Shell::error() const { return stepped_ ? inner_->error() : Controller::error(); }

std::string Shell::reason() const {
  if (state_ == ShellState::start) return "the start signal was not given";
  if (state_ == ShellState::wait) return "its bumper is pressed, or something refused its last motion";
  return state_ == ShellState::control ? reason_of(*inner_) : "";
}

std::string reason_of(const Controller& controller) {
  const auto* states = dynamic_cast<const StatesReason*>(&controller);
  return states == nullptr ? std::string() : states->reason();
}

void Shell::change(const Input& input) {
  if (state_ == ShellState::start && (!settings_.on_signal || input.started)) state_ = ShellState::control;
  const bool pressed = settings_.wait_on_bumper && input.contact;
  if (state_ == ShellState::control && pressed)
    state_ = ShellState::wait;
  else if (state_ == ShellState::wait && !pressed)
    state_ = ShellState::control;
}

}  // namespace sf::control
