#pragma once
// Plug-ins: parts of the program with libraries that load slowly, as shared objects that are loaded at first use.

namespace sf::base {

/// Loads `<name>.so` from the folder of the running program or, where it is not there, from the system's library path,
/// and looks up its symbol `name`. The plug-in stays loaded.
/// @param without consequence for the user of a missing plug-in, e.g. "nothing can be drawn"
/// @param library that the plug-in needs, e.g. "VTK 9.1"
/// @throws InputError naming the file, the reason and the remedy
const void* load_plugin(const char* name, const char* without, const char* library);

}  // namespace sf::base
