#include "world/stage/entity_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "world/stage/color_names.h"

namespace sf::world {

std::uint32_t entity_color(StageContext& context, const Entity& entity, std::string_view key, std::uint32_t fallback,
                           std::uint32_t seed) {
  if (const Property* named = find(entity, key)) {
    const std::string name = text(context, entity, key, "");
    if (name == "random") return 0xFF000000u | base::random_words({0, base::RandomStream::placement, seed, 0, 0}, 0)[0];
    if (const auto color = color_of(name)) return *color;
    warn(context, named->at, fmt::format("unknown colour \"{}\"; expected a name of X11, e.g. \"steel blue\"", name));
    return fallback;
  }
  const auto rgba = tuple(context, entity, "color_rgba", 3, "[red green blue alpha], each from 0 to 1");
  if (!rgba) return fallback;
  const auto channel = [&](std::size_t i) {
    const double value = i < rgba->size() ? (*rgba)[i] : 1.0;
    return static_cast<std::uint32_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
  };
  return channel(3) << 24 | channel(0) << 16 | channel(1) << 8 | channel(2);
}

}  // namespace sf::world
