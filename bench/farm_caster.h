#pragma once
// The farm as a caster: one complete tick per round, including the hash.

#include "bench/caster.h"
#include "gpu/device.h"

namespace sf::bench {

/// `scans` and `device` must outlive it.
std::unique_ptr<Caster> make_farm_caster(const Scans& scans, gpu::Device& device, const std::string& name = "farm");

}  // namespace sf::bench
