#include "bench/spatial_embree.h"

namespace sf::bench {

std::vector<std::unique_ptr<SpatialCaster>> embree_casters(const scene::Mesh&, const std::vector<glm::dvec3>&, double) {
  return {};
}

}  // namespace sf::bench
