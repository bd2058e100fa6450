#pragma once
// Loads shared objects at run time. They are never unloaded.

#include <string>

namespace sf::base {

/// Loads `<name>.so` at its first use (base/installation.h) and returns its symbol `name`. For parts of the program
/// whose libraries load slowly.
/// @param without consequence of a missing plug-in for the user, e.g. "nothing can be drawn"
/// @param library library that the plug-in needs, with its package, e.g. "VTK 9.1 (Debian: libvtk9.1)"
/// @throws InputError naming the file, the reason and the remedy
const void* load_plugin(const char* name, const char* without, const char* library);

/// A library supplied by the user. @throws InputError naming the file and the reason
class SharedLibrary {
 public:
  explicit SharedLibrary(const std::string& file);
  /// Returns null when the library does not export `symbol`.
  void* find(const char* symbol) const;

 private:
  void* handle_;
};

}  // namespace sf::base
