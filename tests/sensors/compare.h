#pragma once
// The farm's readings against the independent answer, beam by beam.

#include <cstddef>
#include <span>
#include <string>

#include "base/reading.h"
#include "farm/farm.h"
#include "world/world.h"

namespace sf::trial {

/// The device that all tests of a program share.
gpu::Device& device();

struct Tally {
  std::size_t beams = 0;
  std::size_t met = 0;          ///< that met something
  std::size_t ambiguous = 0;    ///< that pass a silhouette within 1 um
  std::size_t silhouettes = 0;  ///< of those, decided otherwise than real arithmetic does
  std::size_t wrong = 0;        ///< neither right nor excused
  double worst = 0.0;           ///< [m] of those decided alike and met at 1 mrad or more
  double worst_grazing = 0.0;   ///< [m] of the others that were decided alike
  std::string example;          ///< the first wrong beam

  Tally& operator+=(const Tally& other);
};

/// One line for the log.
std::string text(const Tally& tally);

/// Every beam of `readings`, whose lasers have no noise, resolution 1 and range_min 0. `poses`: of all movers.
Tally compare(const world::World& world, std::span<const base::Pose> poses,
              std::span<const base::ReadingBlock> readings);

/// Expects the same readings, bit by bit.
void expect_same_bits(std::span<const base::ReadingBlock> p, std::span<const base::ReadingBlock> q);

/// One tick of a new farm on `world`, everyone heard and at the pose of the load, compared; and expects the same bits
/// of both casters.
Tally sweep(const world::World& world, const farm::FarmOptions& options = {});

/// Logs `tally` as `name`, and expects no wrong beam and no error above `most` [m].
void expect_exact(const std::string& name, const Tally& tally, double most = 1e-9);

/// Adds a sensor without a body that looks from exactly `pose`, at a height of 0.1 m: the mover's number.
std::uint32_t add_eye(world::World& world, const base::Pose& pose, const world::Laser& laser);

/// A laser at its mover's origin.
world::Laser eye(std::uint32_t samples, double fov, double range_max);

/// Adds an eye whose middle beam is aimed at `target` in double precision.
std::uint32_t aim(world::World& world, glm::dvec2 from, glm::dvec2 target, const world::Laser& laser);

/// One tick at time 0 of a farm that hears everyone; the farm outlives the readings.
struct Glance {
  farm::Farm farm;
  std::span<const base::ReadingBlock> readings;
  explicit Glance(const world::World& world, const farm::FarmOptions& options = {});
};

}  // namespace sf::trial
