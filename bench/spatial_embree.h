#pragma once
// Embree as a peer of spatial scans. Empty where Embree is missing.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bench/lidar_scenes.h"

namespace sf::bench {

/// One way of casting all beams of a sensor.
class SpatialCaster {
 public:
  virtual ~SpatialCaster() = default;
  virtual std::string name() const = 0;
  /// Casts from one pose. @param ranges out: [m] in the order of the beams
  virtual void cast(const base::RigidTransform& X_WS, std::span<double> ranges) = 0;
  /// Embree's numbers of the meshes that the beams of the last cast met: 0, or ~0u for none.
  virtual std::span<const std::uint32_t> labels() const { return {}; }
};

/// Returns Embree's variants: packets of 8 and 16 rays, fast and robust, with the faces as Embree's quads or split into
/// triangles. Their scenes are relative to the mesh's middle.
std::vector<std::unique_ptr<SpatialCaster>> embree_casters(const scene::Mesh& mesh,
                                                           const std::vector<glm::dvec3>& beams, double range_max);

}  // namespace sf::bench
