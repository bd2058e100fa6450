#pragma once
// Users' own controllers as controllers of the farm: those of plug-ins (sensorfarm/plugin.h) and those that a program
// adds.

#include <string>

#include "control/controllers.h"
#include "sensorfarm/plugin.h"

namespace sf::control {

/// Adds the entry for the rest of the program.
/// @param from file that defines it, for messages
/// @throws base::InputError for a name that is taken or unusable, and for an invalid rate
const ControllerType* add_own_controller(sensorfarm::ControllerEntry entry, const std::string& from);

/// Loads the file if it is not yet loaded. @throws base::InputError
const ControllerType* load_controller(const std::string& name);

/// Loads a plug-in and adds all its controllers and sensors. Does nothing if it is already loaded. @throws
/// base::InputError
void load_plugin_file(const std::string& file);

/// Loads all files of a list separated by colons, as in SENSORFARM_PLUGINS; for a folder all its `*.so`, by name.
/// @throws base::InputError
void load_plugin_list(const std::string& list);

}  // namespace sf::control
