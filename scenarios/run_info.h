#pragma once
// Description of a run for its recording.

#include <cstdint>

#include "record/recorder.h"
#include "record/topic_names.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::scenarios {

/// Properties of a run that are not in the world file.
struct RunSettings {
  std::uint64_t seed = 0;
  bool record_readings = false;
  bool no_return_inf = false;                    ///< beams without a return read infinity
  std::string caster;                            ///< description of the ray caster, from `raycast::describe_caster`
  bool estimated = false;                        ///< states are estimates, recorded with their quality
  bool noise = true;                             ///< noisy sensors are noisy
  std::vector<record::JoinedMover> joined = {};  ///< of the world's movers, those that a recording's world lacks
  bool too_near_min = false;  ///< surfaces nearer than a sensor's minimum read that minimum in messages
  record::Naming naming;      ///< of topics and frames
};

/// [m] Largest rounding of a recorded range by base::rep117_range: one step of float32 below range_max, where a range
/// that would be rounded to a limit is rounded to its other side; elsewhere half as much.
inline double recorded_rounding(double range_max) { return 0x1p-23 * range_max; }

/// @throws base::InputError for `plain` names of a world with several robots
record::RunInfo run_info(const world::World& world, const sensors::SensorSet& sensor_set, const RunSettings& settings);

}  // namespace sf::scenarios
