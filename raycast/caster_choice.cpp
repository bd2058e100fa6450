#include "raycast/caster_choice.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string_view>

#include "base/error.h"
#include "raycast/rasterizer.h"

namespace sf::raycast {

CasterChoice choose_caster(bool software, CasterChoice asked) {
  if (asked != CasterChoice::automatic) return asked;
  const char* const set = std::getenv("SENSORFARM_CASTER");
  const std::string_view word = set != nullptr ? set : "";
  if (word == "vulkan") return CasterChoice::vulkan;
  if (word == "host") return CasterChoice::host;
  if (!word.empty() && word != "auto")
    throw base::InputError(fmt::format("SENSORFARM_CASTER={}: expected auto, vulkan or host", word));
  return software ? CasterChoice::host : CasterChoice::vulkan;
}

std::string describe_caster(bool software) {
  return choose_caster(software) == CasterChoice::host ? std::string("host, ") + vector_instructions()
                                                       : "Vulkan kernels";
}

}  // namespace sf::raycast
