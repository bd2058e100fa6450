#include "raycast/caster.h"

#include <cstdlib>
#include <string_view>

#include "raycast/rasterizer.h"

namespace sf::raycast {

Caster caster_for(bool software, Caster asked) {
  if (asked != Caster::automatic) return asked;
  const char* const set = std::getenv("SENSORFARM_CASTER");
  const std::string_view word = set != nullptr ? set : "";
  if (word == "vulkan") return Caster::vulkan;
  return word == "host" || software ? Caster::host : Caster::vulkan;
}

std::string caster_text(bool software) {
  return caster_for(software) == Caster::host ? std::string("host, ") + vector_instructions() : "Vulkan kernels";
}

}  // namespace sf::raycast
