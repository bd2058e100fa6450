#pragma once
// Measures the errors of a caster: compares a sample of its beams with the tests' brute force.

#include "base/reading.h"
#include "bench/caster.h"

namespace sf::bench {

struct AccuracyCheck {
  double max_error_m = 0.0;   ///< [m] over the compared beams
  std::size_t beams = 0;      ///< number of compared beams
  std::size_t at_vertex = 0;  ///< skipped: within 10 um of a segment's end, where 32-bit arithmetic may hit or miss
};

/// Compares all beams of `robots` robots, spread over the fleet, after `caster` has cast `round`.
AccuracyCheck check_accuracy(const Caster& caster, const Scans& scans, std::size_t round, std::size_t robots);

/// The same for readings of lasers among moving bodies.
/// @param poses one per mover, at the time of the readings
AccuracyCheck check_accuracy(std::span<const base::ReadingBlock> readings, const world::World& world,
                             std::span<const base::Pose> poses, std::size_t robots);

}  // namespace sf::bench
