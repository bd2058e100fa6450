#pragma once
// Where the program or library stands, and the files that are installed with it.

#include <string>

namespace sf::base {

/// Folder of the program or shared library that contains the farm's code.
std::string own_folder();

/// `file` where it exists or is absolute; else that file below SENSORFARM_DATA, or below share/sensorfarm/ of the
/// installation, if it exists there; else `file`.
std::string installed_file(const std::string& file);

}  // namespace sf::base
