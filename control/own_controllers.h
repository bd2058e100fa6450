#pragma once
// Users' own controllers: those of plug-ins (sensorfarm/plugin.h) and those that a program adds, as controllers of the
// farm.

#include <string>
#include <string_view>

#include "control/controllers.h"
#include "sensorfarm/plugin.h"

namespace sf::control {

/// Adds it for the rest of the program.
/// @param from file it comes from, for messages
/// @throws base::InputError for a name that is taken or unusable, and for an invalid rate
const ControllerType* add_own_controller(sensorfarm::ControllerEntry entry, const std::string& from);

/// "./libmine.so", "folder/libmine.so:name" or "mine.py:Class", not a plain name.
bool names_a_file(std::string_view name);

/// Loads the file where it is not loaded yet. @throws base::InputError
const ControllerType* load_controller(const std::string& name);

/// Loads a plug-in and adds everything in it. Loading it again changes nothing. @throws base::InputError
void load_plugin_file(const std::string& file);

/// Loads all files of a list separated by colons, as in SENSORFARM_PLUGINS; of a folder all its `*.so`, by name.
/// @throws base::InputError
void load_plugin_list(const std::string& list);

}  // namespace sf::control
