#pragma once
// How wrong a caster is: a sample of its beams against the tests' brute force.

#include "base/reading.h"
#include "bench/caster.h"

namespace sf::bench {

struct AccuracyCheck {
  double max_error_m = 0.0;   ///< [m] over the beams that count
  std::size_t beams = 0;      ///< compared
  std::size_t at_vertex = 0;  ///< left out: they pass an end of a segment within 10 um, where 32 bits may go either way
};

/// Compares what `caster` answered to `round` for `robots` robots, spread over the fleet, with all their beams.
AccuracyCheck check_accuracy(const Caster& caster, const Scans& scans, std::size_t round, std::size_t robots);

/// The same for readings of lasers among moving bodies. `poses`: one per mover, as of the readings.
AccuracyCheck check_accuracy(std::span<const base::ReadingBlock> readings, const world::World& world,
                             std::span<const base::Pose> poses, std::size_t robots);

}  // namespace sf::bench
