#pragma once
// Runs a user's own controller as a controller of the farm: translates its inputs, and converts its exceptions into
// errors with the robot's name.

#include <memory>

#include "control/controllers.h"
#include "sensorfarm/controller.h"

namespace sf::control {

/// `ControllerType::make` of all types with an entry.
std::unique_ptr<Controller> make_own_controller(const ControllerContext& context, Settings& settings);

/// Returns the robot as described to its controller. @throws base::InputError for a sensor with invalid settings
sensorfarm::Robot robot_of(const ControllerContext& context);

}  // namespace sf::control
