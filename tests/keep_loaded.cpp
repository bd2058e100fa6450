// Only for builds with sanitizers. Vulkan's loader closes a driver's library at the end. The driver's leaks then have
// no symbol names, so tests/lsan.supp cannot distinguish them from leaks of this project. Libraries therefore stay
// loaded.

#include <dlfcn.h>

extern "C" int dlclose(void*) noexcept { return 0; }
