#include "server/wire_ids.h"

namespace sf::server {

WireNames wire_names(const world::World& world) {
  WireNames names;
  for (std::uint32_t i = 0; i < world.movers.size(); ++i)
    (world.movers[i].is_tag ? names.tags : names.robots)[world.movers[i].id] = i;
  return names;
}

std::vector<std::uint32_t> ids_of(const std::map<std::uint32_t, std::uint32_t>& rows) {
  std::vector<std::uint32_t> ids;
  for (const auto& [id, row] : rows) ids.push_back(id);
  return ids;
}

}  // namespace sf::server
