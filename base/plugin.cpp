#include "base/plugin.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "base/error.h"
#include "base/installation.h"

namespace sf::base {

const void* load_plugin(const char* name, const char* without, const char* library) {
  const std::string file = plugin_file(name);
  void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  const void* symbol = module != nullptr ? dlsym(module, name) : nullptr;
  if (symbol != nullptr) return symbol;
  const char* const why = dlerror();
  throw InputError(file, 0,
                   fmt::format("cannot be loaded, so {} ({}): keep it beside the program, and {} installed", without,
                               why != nullptr ? why : "?", library));
}

SharedLibrary::SharedLibrary(const std::string& file) {
  std::error_code error;
  const auto whole = std::filesystem::canonical(file, error);  // dlopen searches elsewhere for a name without a folder
  if (error) throw InputError(file, 0, "cannot be opened: " + error.message());
  handle_ = dlopen(whole.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ != nullptr) return;
  const char* const why = dlerror();
  throw InputError(file, 0, fmt::format("cannot be loaded as a shared library: {}", why != nullptr ? why : "?"));
}

void* SharedLibrary::find(const char* symbol) const { return dlsym(handle_, symbol); }

}  // namespace sf::base
