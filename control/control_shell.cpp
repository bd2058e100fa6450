#include "control/control_shell.h"

#include <utility>

#include "base/error.h"

namespace sf::control {

ControlShellSettings read_control_shell_settings(Settings& settings, bool stops_on_bumper) {
  ControlShellSettings read;
  read.on_signal = settings.choice("start", "at-once", {"at-once", "signal"}) == "signal";
  read.wait_on_bumper = settings.flag("wait_on_bumper", stops_on_bumper);
  const bool set = settings.has("localize"), localize = settings.flag("localize", false);
  if (set) read.localize = localize;
  read.monitor = settings.flag("monitor", false);
  if (read.monitor && !read.localize.value_or(true))
    settings.refuse("monitor", "'monitor' is for robots that localize themselves; expected localize = true");
  return read;
}

ControlShell::ControlShell(std::unique_ptr<Controller> inner, const ControlShellSettings& settings,
                           std::optional<OwnLocalization> localization)
    : inner_(std::move(inner)),
      sharing_(dynamic_cast<SharesMap*>(inner_.get())),
      settings_(settings),
      localization_(std::move(localization)) {
  SF_CHECK(inner_ != nullptr, "a shell without a controller");
}

base::Twist ControlShell::step(const ControllerInput& given) {
  const ControllerInput input = localization_ ? localization_->localize(given) : given;
  change(input);
  if (localization_ && localization_->is_lost()) return stepped_ = false, base::Twist{};
  stepped_ = state_ == ControlShellState::control;
  if (!stepped_) return {};
  const base::Twist twist = inner_->step(input);
  if (!inner_->done()) return twist;
  state_ = ControlShellState::stop;
  return {};
}

double ControlShell::error() const { return stepped_ ? inner_->error() : Controller::error(); }

std::string ControlShell::stop_reason() const {
  if (localization_ && localization_->is_lost()) return "its pose is unknown: no camera has seen it yet";
  if (state_ == ControlShellState::start) return "the start signal has not arrived";
  if (state_ == ControlShellState::wait) return "its bumper is pressed, or its last motion was blocked";
  return state_ == ControlShellState::control ? stop_reason_of(*inner_) : "";
}

std::string stop_reason_of(const Controller& controller) {
  const auto* states = dynamic_cast<const StatesStopReason*>(&controller);
  return states == nullptr ? std::string() : states->stop_reason();
}

const OwnLocalization* localization_of(const Controller& controller) {
  const auto* shell = dynamic_cast<const ControlShell*>(&controller);
  return shell == nullptr ? nullptr : shell->localization();
}

void ControlShell::change(const ControllerInput& input) {
  if (state_ == ControlShellState::start && (!settings_.on_signal || input.started))
    state_ = ControlShellState::control;
  const bool pressed = settings_.wait_on_bumper && input.contact;
  if (state_ == ControlShellState::control && pressed)
    state_ = ControlShellState::wait;
  else if (state_ == ControlShellState::wait && !pressed)
    state_ = ControlShellState::control;
}

}  // namespace sf::control
