#include "gpu/vulkan_functions.h"

#include <dlfcn.h>

namespace sf::gpu {

#define SF_DEFINE_FUNCTION(name) PFN_##name name = nullptr;
SF_VULKAN_FUNCTIONS(SF_DEFINE_FUNCTION)
#undef SF_DEFINE_FUNCTION

namespace {

constexpr const char* kLoader = "libvulkan.so.1";

template <class Function>
void find(void* loader, const char* name, Function& function, std::string& problem) {
  function = reinterpret_cast<Function>(dlsym(loader, name));
  if (function == nullptr && problem.empty()) problem = std::string(kLoader) + " has no " + name;
}

std::string open_and_find() {
  void* const loader = dlopen(kLoader, RTLD_NOW | RTLD_LOCAL);
  if (loader == nullptr) return std::string("Vulkan's loader ") + kLoader + " is not installed";
  std::string problem;
#define SF_FIND_FUNCTION(name) find(loader, #name, name, problem);
  SF_VULKAN_FUNCTIONS(SF_FIND_FUNCTION)
#undef SF_FIND_FUNCTION
  return problem;
}

}  // namespace

const std::string& open_vulkan_loader() {
  static const std::string problem = open_and_find();
  return problem;
}

}  // namespace sf::gpu
