#include "viz/pen.h"

#include <dlfcn.h>

#include <filesystem>

#include "base/error.h"

namespace sf::viz {

namespace {

constexpr const char* kModule = "sensorfarm_pen.so";

const Pen* load() {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::string beside = (program.parent_path() / kModule).string();
  void* module = dlopen(std::filesystem::exists(beside, ignored) ? beside.c_str() : kModule, RTLD_NOW | RTLD_LOCAL);
  const void* symbol = module != nullptr ? dlsym(module, kPenSymbol) : nullptr;
  if (symbol != nullptr) return static_cast<const Pen*>(symbol);
  const char* const why = dlerror();
  throw base::InputError(beside, 0,
                         std::string("cannot be loaded, so nothing can be drawn (") + (why != nullptr ? why : "?") +
                             "): keep it beside the program, and VTK 9.1 installed");
}

}  // namespace

const Pen& pen() {
  static const Pen* const loaded = load();
  return *loaded;
}

}  // namespace sf::viz
