#pragma once
// Passes the readings of a recording through derived sensors, including those that did not exist when it was made.
//
// Time passes as in the run: each reading is processed when it was delivered, and each derived sensor is evaluated at
// its own times. So the result has the bytes that the run would have had, for any number of threads.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/tick_record.h"
#include "record/recording.h"
#include "world/world.h"

namespace sf::scenarios {

/// A recording and its world, with derived sensors in addition to those of the run.
struct DerivedSource {
  record::Recording recording;
  world::World world;
  /// Measured by other programs: states are unknown (base::kAbsent), and each reading is delivered exactly at
  /// `ReadingSample::delivered`, at times that need not be those of ticks.
  bool foreign = false;
};

struct DerivedReplayOptions {
  unsigned threads = 0;  ///< 0: all cores
  /// Called with the completed fraction in [0, 1]; returns false to stop; may be empty.
  std::function<bool(double)> progress;
};

/// Counts of a replay.
struct DerivedReplay {
  std::uint64_t ticks = 0;
  std::uint64_t inputs = 0;   ///< recorded readings of measured sensors that were delivered
  std::uint64_t derived = 0;  ///< readings of derived sensors
  std::uint64_t equal = 0;    ///< of these, recorded ones: recomputed with the same bits
  std::uint64_t different = 0;
  std::string first;                     ///< place of the first difference
  std::vector<std::string> never_valid;  ///< DerivedSensors::never_valid
  bool interrupted = false;
};

/// Returns the description of the derived recording.
record::RunInfo derived_run_info(const DerivedSource& source);

/// Passes each tick, with all its readings, to `sink`; those of derived sensors are computed.
/// @throws base::InputError for a recording without the states of all movers or without readings, for readings that
/// sensors of its world cannot have, and for more than 1e9 readings of derived sensors
DerivedReplay replay_derived(const DerivedSource& source, base::Sink& sink, const DerivedReplayOptions& options);

}  // namespace sf::scenarios
