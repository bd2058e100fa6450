#pragma once
// Comparison of the farm's readings with the brute-force reference, beam by beam.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "base/reading.h"
#include "farm/farm.h"
#include "sensors/laser_settings.h"
#include "tests/device.h"
#include "world/world.h"

namespace sf::trial {

struct Tally {
  std::size_t beams = 0;
  std::size_t met = 0;           ///< beams with a hit
  std::size_t ambiguous = 0;     ///< beams within 1 um of a silhouette
  std::size_t silhouettes = 0;   ///< number of these that are decided differently than in real arithmetic
  std::size_t wrong = 0;         ///< neither valid nor ambiguous
  std::size_t beyond_bound = 0;  ///< decided alike, at 1 mrad or more, with an error above the reading's bound
  double worst = 0.0;            ///< [m] error of beams decided alike, at 1 mrad or more
  double worst_grazing = 0.0;    ///< [m] error of beams decided alike, below 1 mrad
  std::string example;           ///< description of the first wrong beam

  Tally& operator+=(const Tally& other);
};

/// Returns one line for the log.
std::string text(const Tally& tally);

/// Compares every beam of `readings`. The lasers have no noise, resolution 1 and range_min 0. @param poses of all
/// movers
Tally compare(const world::World& world, std::span<const base::Pose> poses,
              std::span<const base::ReadingBlock> readings);

/// Returns the poses of all movers at load.
std::vector<base::Pose> loaded_poses(const world::World& world);

/// Expects equal readings, bit by bit.
void expect_same_bits(std::span<const base::ReadingBlock> p, std::span<const base::ReadingBlock> q);

/// Compares one tick of a new farm on `world`, with all robots subscribed at their poses at load, for every caster.
/// Casters whose `CasterType::same_bytes` is true must produce equal bits. Others cast the scene if it is small, and
/// must stay within their bounds. @return the host's tally
Tally sweep(const world::World& world, const farm::FarmOptions& options = {});

/// Logs `tally` as `name`, and expects no wrong beam and no error above `most` [m].
void expect_exact(const std::string& name, const Tally& tally, double most = 1e-9);

/// Adds a sensor without a body at exactly `pose`, at a height of 0.1 m. @return the mover's row
std::uint32_t add_eye(world::World& world, const base::Pose& pose, const sensors::LaserSettings& laser);

/// Returns a laser at its mover's origin.
sensors::LaserSettings eye(std::uint32_t samples, double fov, double range_max);

/// Adds an eye whose middle beam is aimed at `target` in double precision.
std::uint32_t aim(world::World& world, glm::dvec2 from, glm::dvec2 target, const sensors::LaserSettings& laser);

/// Runs one tick at time 0 of a farm with all robots subscribed. The farm outlives the readings.
struct Glance {
  farm::Farm farm;
  std::span<const base::ReadingBlock> readings;
  explicit Glance(const world::World& world, const farm::FarmOptions& options = {});
};

}  // namespace sf::trial
