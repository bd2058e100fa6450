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
  bool no_return_inf = false;                    ///< beams without a return are recorded as infinity
  std::string caster;                            ///< description of the ray caster, from `raycast::describe_caster`
  bool estimated = false;                        ///< states are estimates, recorded with their quality
  bool noise = true;                             ///< noisy sensors have noise
  std::vector<record::JoinedMover> joined = {};  ///< movers of the world that were not in the recording's world
  bool too_near_min = false;     ///< surfaces nearer than a sensor's minimum range are recorded as that minimum
  record::Naming naming;         ///< of topics and frames
  record::ImageMessages images;  ///< of cameras
  std::string faults = {};       ///< of sensors (faults_text); empty: none
};

/// [m] Largest rounding of a range recorded by base::rep117_range: one float32 step below range_max, where a range that
/// would be rounded to a limit is rounded to its other side; half as much elsewhere.
inline double recorded_rounding(double range_max) { return 0x1p-23 * range_max; }

/// @throws base::InputError for `plain` names of a world with several robots
record::RunInfo run_info(const world::World& world, const sensors::SensorSet& sensor_set, const RunSettings& settings);

}  // namespace sf::scenarios
