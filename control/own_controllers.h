#pragma once
// Users' own controllers of robots and models: those of plug-ins (sensorfarm/plugin.h) and those that a program adds.

#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "control/controllers.h"
#include "sensorfarm/plugin.h"

namespace sf::control {

/// Adds the entry for the rest of the program.
/// @param from file that defines it, for messages
/// @throws base::InputError for a name that is taken or unusable, and for an invalid rate
const ControllerType* add_own_controller(sensorfarm::ControllerEntry entry, const std::string& from);

/// The same for a controller of models, whose name differs from those of all controllers.
const sensorfarm::ModelEntry* add_own_model_controller(sensorfarm::ModelEntry entry, const std::string& from);

/// Loads the file if it is not yet loaded. @throws base::InputError
const ControllerType* load_controller(const std::string& name);

/// @param name as in `find_controller`
/// @throws base::InputError for a file that cannot be loaded, and for an unknown name, with the known ones
const sensorfarm::ModelEntry& find_model_controller(const std::string& name);
/// Returns the dynamics in a plug-in's file, which is loaded if it is not yet loaded.
/// @param name "./libmine.so" or "./libmine.so:name"
/// @throws base::InputError for a file that cannot be loaded or has none
const sensorfarm::DynamicsEntry& find_dynamics(const std::string& name);
/// Returns the controllers of models in the order in which they were added.
const std::deque<sensorfarm::ModelEntry>& model_controllers();
/// Returns their names, for world::LoadOptions.
std::vector<std::string_view> model_controller_names();

/// Loads a plug-in and adds all that it contains. Does nothing if it is already loaded. @throws
/// base::InputError
void load_plugin_file(const std::string& file);

/// Loads all files of a list separated by colons, as in SENSORFARM_PLUGINS; for a folder all its `*.so`, by name.
/// @throws base::InputError
void load_plugin_list(const std::string& list);

}  // namespace sf::control
