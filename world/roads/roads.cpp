#include "world/roads/roads.h"

namespace sf::world {

RoadNetwork load_roads(const std::string& rndf_file, std::vector<Warning>& warnings, bool strict) {
  const Rndf rndf = read_rndf(rndf_file, strict);
  warnings.insert(warnings.end(), rndf.warnings.begin(), rndf.warnings.end());
  const RoadSidecar sidecar = read_sidecar(rndf_file, warnings);
  return build_network(rndf, sidecar, warnings);
}

std::optional<RoadNetwork> roads_of(const World& world) {
  if (world.road_files.empty()) return std::nullopt;
  std::vector<Warning> ignored_warnings;
  return load_roads(world.road_files.front(), ignored_warnings);
}

}  // namespace sf::world
