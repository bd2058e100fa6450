#pragma once
// Where the program or library stands, and the files that are installed with it.

#include <string>
#include <vector>

namespace sf::base {

/// Folders of plug-ins: that of the program or shared library that contains the farm's code, then the installation's.
std::vector<std::string> plugin_folders();

/// The plug-in's file of that name in the first of `plugin_folders` that has it; else the name alone, which the
/// system's library path may find.
std::string plugin_file(const std::string& name);

/// `file` where it exists or is absolute; else that file below SENSORFARM_DATA, or below share/sensorfarm/ of the
/// installation or build folder, if it exists there; else `file`.
std::string installed_file(const std::string& file);

}  // namespace sf::base
