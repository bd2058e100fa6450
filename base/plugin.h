#pragma once
// Shared objects that are loaded as the program runs. They stay loaded.

#include <string>

namespace sf::base {

/// Loads `<name>.so`, a part of the program with libraries that load slowly, at its first use (base/installation.h),
/// and looks up its symbol `name`.
/// @param without consequence for the user of a missing plug-in, e.g. "nothing can be drawn"
/// @param library that the plug-in needs, with its package, e.g. "VTK 9.1 (Debian: libvtk9.1)"
/// @throws InputError naming the file, the reason and the remedy
const void* load_plugin(const char* name, const char* without, const char* library);

/// A user's own library. @throws InputError naming the file and the reason
class SharedLibrary {
 public:
  explicit SharedLibrary(const std::string& file);
  /// Null: the library does not export it.
  void* find(const char* symbol) const;

 private:
  void* handle_;
};

}  // namespace sf::base
