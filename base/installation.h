#pragma once
// Locates the program or library and the files installed with it.

#include <string>
#include <string_view>
#include <vector>

namespace sf::base {

/// Returns the folders searched for plug-ins: the folder of the program or shared library that contains the farm's
/// code, then the installation's.
std::vector<std::string> plugin_folders();

/// Returns the path of the plug-in `name` in the first of `plugin_folders` that contains it, or the plain file name,
/// which the system's library path may resolve.
std::string plugin_file(const std::string& name);

/// Returns whether a controller's name has the form "./libmine.so", "folder/libmine.so:name" or "mine.py:Class",
/// instead of a plain name.
bool names_a_plugin(std::string_view name);

/// Returns `file` if it exists or is absolute. Otherwise returns the file below SENSORFARM_DATA, or below
/// share/sensorfarm/ of the installation or build folder, if it exists there. Otherwise returns `file`.
std::string installed_file(const std::string& file);

}  // namespace sf::base
