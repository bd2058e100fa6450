#pragma once
// A user's own controller as a controller of the farm: translates its inputs, and its exceptions into errors with the
// robot's name.

#include <memory>

#include "control/controllers.h"

namespace sf::control {

/// `ControllerType::make` of all types with an entry.
std::unique_ptr<Controller> make_own_controller(const ControllerContext& context, Settings& settings);

}  // namespace sf::control
