#include "viz/text_renderer.h"

#include <dlfcn.h>

#include <filesystem>

#include "base/error.h"

namespace sf::viz {

namespace {

constexpr const char* kModule = "sensorfarm_text_renderer.so";

const TextRenderer* load() {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::string beside = (program.parent_path() / kModule).string();
  void* module = dlopen(std::filesystem::exists(beside, ignored) ? beside.c_str() : kModule, RTLD_NOW | RTLD_LOCAL);
  const void* symbol = module != nullptr ? dlsym(module, kTextRendererSymbol) : nullptr;
  if (symbol != nullptr) return static_cast<const TextRenderer*>(symbol);
  const char* const why = dlerror();
  throw base::InputError(beside, 0,
                         std::string("cannot be loaded, so nothing can be drawn (") + (why != nullptr ? why : "?") +
                             "): keep it beside the program, and VTK 9.1 installed");
}

}  // namespace

const TextRenderer& text_renderer() {
  static const TextRenderer* const loaded = load();
  return *loaded;
}

}  // namespace sf::viz
