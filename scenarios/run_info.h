#pragma once
// What a recording says of its run.

#include <cstdint>

#include "record/recorder.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::scenarios {

/// What the world does not say of a run.
struct RunSettings {
  std::uint64_t seed = 0;
  bool record_readings = false;
  bool no_return_inf = false;  ///< beams that met nothing read infinity
  std::string caster;          ///< what casts rays, as `raycast::describe_caster` has it
};

record::RunInfo run_info(const world::World& world, const sensors::SensorSet& sensor_set, const RunSettings& settings);

}  // namespace sf::scenarios
