#include "control/remote.h"

#include "base/time.h"
#include "control/control_shell.h"

namespace sf::control {

base::Twist Remote::step(const ControllerInput& input) {
  if (command_ && input.time - time_ > timeout_) command_.reset();
  return command_.value_or(base::Twist{});
}

Remote* remote_of(Controller& controller) {
  auto* shell = dynamic_cast<ControlShell*>(&controller);
  return dynamic_cast<Remote*>(shell == nullptr ? &controller : &shell->inner());
}

namespace {

std::unique_ptr<Controller> make_remote(const ControllerContext&, Settings& settings) {
  return std::make_unique<Remote>(base::nanoseconds(settings.number("timeout", 0.5, 0.05, 60.0)));
}

}  // namespace

/// Its driver backs off from obstacles, so a pressed bumper does not stop it.
constinit const ControllerType remote_controller{
    .name = "remote",
    .summary = "drives by commands of Player clients of `serve --player`; stops when none arrives; rests in `run`",
    .rate = 20.0,
    .stops_on_bumper = false,
    .make = make_remote,
};

}  // namespace sf::control
