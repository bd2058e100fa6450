#pragma once
// Embree (version 3) as a caster: walls are upright surfaces that intersect the scan plane.

#include "bench/caster.h"

namespace sf::bench {

/// Options for Embree. Packets of 16 are native on processors with AVX-512.
struct EmbreeUse {
  std::size_t packet = 8;  ///< adjacent beams per packet, declared coherent: 8 or 16; 1: single beams
  bool robust = false;     ///< slower intersection test without gaps at shared edges
};

/// `scans` must outlive it. Null if the benchmarks are built without Embree.
std::unique_ptr<Caster> make_embree_caster(const Scans& scans, const EmbreeUse& use);

}  // namespace sf::bench
