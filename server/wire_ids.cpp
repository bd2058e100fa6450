#include "server/wire_ids.h"

#include "world/lights.h"

namespace sf::server {

WireNames wire_names(const world::World& world) {
  WireNames names;
  std::vector<bool> posts(world.movers.size(), false);
  for (const world::Light& light : world.lights)
    if (const auto post = carrier_of(world, light); post != world::kNone) posts[post] = true;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i) {
    const world::Mover& mover = world.movers[i];
    (posts[i] ? names.lights : mover.is_tag ? names.tags : names.robots)[mover.id] = i;
  }
  return names;
}

std::vector<std::uint32_t> ids_of(const std::map<std::uint32_t, std::uint32_t>& rows) {
  std::vector<std::uint32_t> ids;
  for (const auto& [id, row] : rows) ids.push_back(id);
  return ids;
}

}  // namespace sf::server
