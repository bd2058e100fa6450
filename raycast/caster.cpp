#include "raycast/caster.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "raycast/rasterizer.h"

namespace sf::raycast {

Caster caster_for(bool software, Caster asked) {
  if (asked != Caster::automatic) return asked;
  const char* const set = std::getenv("SENSORFARM_CASTER");
  const std::string_view word = set != nullptr ? set : "";
  if (word == "vulkan") return Caster::vulkan;
  if (word == "host") return Caster::host;
  if (!word.empty() && word != "auto")
    throw base::InputError(fmt::format("SENSORFARM_CASTER={}: expected auto, vulkan or host", word));
  return software ? Caster::host : Caster::vulkan;
}

std::string caster_text(bool software) {
  return caster_for(software) == Caster::host ? std::string("host, ") + vector_instructions() : "Vulkan kernels";
}

}  // namespace sf::raycast
