#include "world/roads/roads.h"

namespace sf::world {

RoadNetwork load_roads(const std::string& rndf_file, std::vector<Warning>& warnings) {
  const Rndf rndf = read_rndf(rndf_file);
  warnings.insert(warnings.end(), rndf.warnings.begin(), rndf.warnings.end());
  const RoadSidecar sidecar = read_sidecar(rndf_file, warnings);
  return build_network(rndf, sidecar, warnings);
}

}  // namespace sf::world
