#pragma once
// Embree (version 3) as a caster: walls stand upright across the plane of the scan.

#include "bench/caster.h"

namespace sf::bench {

/// How Embree is asked.
struct EmbreeUse {
  bool packets = true;  ///< eight adjacent beams together, said to be coherent; false: one by one
  bool robust = false;  ///< its slower test, which lets nothing slip through shared edges
};

/// `scans` must outlive it. Null where the benchmarks were built without Embree.
std::unique_ptr<Caster> make_embree_caster(const Scans& scans, const EmbreeUse& use);

}  // namespace sf::bench
