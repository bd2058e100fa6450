#include "bridges/dds.h"

#include "base/plugin.h"

namespace sf::bridges {

const DdsLibrary& dds_library() {
  static const auto* const loaded = static_cast<const DdsLibrary*>(
      base::load_plugin(kDdsSymbol, "ROS 2 nodes cannot be reached", "Cyclone DDS 0.10 (Debian: libddsc0debian)"));
  return *loaded;
}

}  // namespace sf::bridges
