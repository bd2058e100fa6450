#pragma once
// A kept run, read back: whole, still being written, or cut short.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "record/fleet_message.h"
#include "record/ros_messages.h"
#include "record/run_info.h"

namespace sf::record {

/// One mover at one tick.
struct StateSample {
  std::uint64_t tick = 0;
  std::int64_t time = 0;  ///< [ns] simulated
  bool contact = false;
  base::Pose X_WM;
  base::Twist velocity;
  base::Twist command;
};

/// One kept scan.
struct ScanSample {
  std::uint32_t mover = 0;   ///< row in `RunInfo::movers`
  std::uint32_t sensor = 0;  ///< among the mover's lasers
  std::uint32_t sequence = 0;
  std::int64_t delivered = 0;  ///< [ns] simulated time of the tick that delivered it; `scan.time` is the measurement's
  Scan scan;
};

/// One kept reading of a sensor of any other kind.
struct ReadingSample {
  std::uint32_t mover = 0;   ///< row in `RunInfo::movers`
  std::uint8_t kind = 0;     ///< id of a row of `RunInfo::sensor_types`
  std::uint32_t sensor = 0;  ///< among the mover's sensors of this kind
  std::uint32_t sequence = 0;
  std::int64_t delivered = 0;  ///< [ns] simulated time of the tick that delivered it
  std::int64_t time = 0;       ///< [ns] of the measurement
  std::vector<double> values;  ///< element by element, as the kind's columns say
};

struct Recording {
  std::string file;
  RunInfo info;                                  ///< with the world's snapshot
  std::vector<std::vector<StateSample>> states;  ///< by mover, then by tick
  std::vector<ScanSample> scans;                 ///< in order of delivery; empty when not recorded
  std::vector<ReadingSample> readings;           ///< likewise
  std::uint64_t ticks = 0;                       ///< ticks in the file
  std::int64_t end_time = 0;                     ///< [ns] simulated time of the last one
  bool truncated = false;                        ///< not finished: killed, or still running; every whole tick is here
  std::vector<std::string> damage;  ///< what does not fit its checksums or cannot be understood, and was left out
};

/// @param directory as given to the recorder, or an MCAP file itself.
/// @throws base::InputError when there is no recording, it is not one of ours, or its world is missing.
Recording open_recording(const std::string& directory);

/// The same from bytes in memory. @param name of the file, for messages.
Recording read_recording(std::span<const std::uint8_t> bytes, const std::string& name);

}  // namespace sf::record
