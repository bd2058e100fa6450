#pragma once
// The laser range finder by the plainest means: every beam against every segment, one after another, on the host.
//
// Its arithmetic is that of shaders/lib/intersect.glsl, operation by operation, so its scans are the device's to the
// bit, noise and `resolution` included: what devices are held to, and what recordings are checked against. A laser in
// mode `single` is cast as an exact one. It shares with the farm how beams are laid out and noise is drawn
// (raycast/beams.h, sensors/laser_noise.h), nothing of how surfaces are found. Some microseconds a beam in a world of a
// thousand walls.

#include <cstdint>
#include <span>
#include <vector>

#include "raycast/intersect.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Immutable between two calls of `place`: several threads may scan. `world` must outlive it.
class LaserReference {
 public:
  /// @param noise false: none, whatever the world says
  LaserReference(const world::World& world, std::uint64_t seed, bool noise = true);

  /// Moves every mover to its pose: one a mover. Until then they stand where they were loaded.
  void set_poses(std::span<const Pose> poses);

  struct Scan {
    Pose X_WS;
    std::vector<double> ranges;       ///< [m] one per sample, as in base::ReadingBlock
    std::vector<std::uint32_t> hits;  ///< likewise
  };
  /// One reading of a mover's laser. @param sequence names its noise
  Scan scan(std::uint32_t mover, std::uint32_t laser, std::uint64_t sequence) const;

 private:
  struct Seen {
    raycast::CandidateSegment surface;
    std::uint32_t model;
  };
  std::vector<Seen> in_sight(std::uint32_t self, const Pose& X_WS, double range) const;

  const world::World& world_;
  std::uint64_t seed_;
  bool noise_;
  std::vector<Pose> poses_;
};

}  // namespace sf::sensors
