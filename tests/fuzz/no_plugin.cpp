// Fuzz targets of file readers have no plug-ins.

#include "base/error.h"
#include "base/plugin.h"

namespace sf::base {

const void* load_plugin(const char* name, const char*, const char*) { throw InputError(name, 0, "is not loaded here"); }

}  // namespace sf::base
