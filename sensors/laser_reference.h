#pragma once
// Reference implementation of the laser: every beam against every segment, in sequence, on the host.
//
// It uses the arithmetic of shaders/lib/intersect.glsl, operation by operation, so its scans equal the device's bit by
// bit, including noise and `resolution`. Devices are tested and recordings are verified against it. A laser in mode
// `single` is cast as an exact one. Beam layout and noise are shared with the farm (raycast/beams.h,
// sensors/laser_noise.h); the search for surfaces is not. A beam takes some microseconds in a world of a thousand
// walls.

#include <cstdint>
#include <span>
#include <vector>

#include "raycast/intersect.h"
#include "sensors/laser_modes.h"

namespace sf::sensors {

/// Immutable between two calls of `set_poses`, so several threads may scan. `world` must outlive it.
class LaserReference {
 public:
  /// @param noise false: adds no noise, whatever the world file says
  /// @throws base::InputError for a laser with invalid settings
  LaserReference(const world::World& world, std::uint64_t seed, bool noise = true);

  /// Returns a mover's laser with the settings that its beams are cast with.
  const CastLaser& laser(std::uint32_t mover, std::uint32_t number) const { return lasers_[mover][number]; }

  /// Sets the pose of every mover. Initially movers are at their poses at load.
  void set_poses(std::span<const Pose> poses);

  struct Scan {
    Pose X_WS;
    std::vector<double> ranges;              ///< [m] one per sample, as in base::ReadingBlock
    std::vector<std::uint32_t> hits;         ///< model per sample, as in base::ReadingBlock
    std::vector<base::QualityFlag> quality;  ///< per sample: too_near or none
  };
  /// Returns one reading of a mover's laser. @param sequence key of its noise
  /// @param slack [m] surfaces within this distance of range_min are treated as being at range_min, or just nearer if
  /// it is negative. These are the two readings that 32-bit range errors may produce.
  Scan scan(std::uint32_t mover, std::uint32_t number, std::uint64_t sequence, double slack = 0.0) const;

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
  std::vector<std::vector<CastLaser>> lasers_;  ///< of each mover
};

}  // namespace sf::sensors
