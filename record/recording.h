#pragma once
// Reads recordings: complete, still being written, or truncated.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/fault.h"
#include "base/report.h"
#include "record/fleet_message.h"
#include "record/run_info.h"
#include "record/shapes_message.h"

namespace sf::record {

/// One mover at one tick.
struct StateSample {
  std::uint64_t tick = 0;
  std::int64_t time = 0;  ///< [ns] simulated
  bool contact = false;
  base::Pose X_WM;
  base::Twist velocity;
  base::Twist command;
  base::Tilt tilt;
  base::WheelSpeeds wheels;
};

inline base::Report report_of(const StateSample& state, std::uint32_t mover) {
  return {mover, state.time, state.X_WM, state.velocity, state.tilt, 0, state.wheels};
}

/// One recorded reading.
struct ReadingSample {
  std::uint32_t mover = 0;   ///< row in `RunInfo::movers`
  std::uint8_t type = 0;     ///< id of a row of `RunInfo::sensor_types`
  std::uint32_t sensor = 0;  ///< 0-based among the mover's sensors of this type
  std::uint32_t sequence = 0;
  std::int64_t delivered = 0;  ///< [ns] simulated time of the tick of delivery
  std::int64_t time = 0;       ///< [ns] time of the measurement
  std::size_t width = 0;       ///< numbers per element, those of the sensor type's first columns
  /// Element by element, in the order of the sensor type's columns; scans in float32. A range of -infinity means a
  /// surface nearer than the sensor's minimum; a range from the sensor's maximum on means no echo.
  std::vector<double> values;
};

/// All traffic lights at one tick.
struct LightsSample {
  std::int64_t time = 0;                  ///< [ns] simulated
  std::vector<base::LightStatus> lights;  ///< one per light of the world
};

struct Recording {
  std::string file;
  RunInfo info;                                  ///< includes the world's snapshot
  std::vector<std::vector<StateSample>> states;  ///< by mover, then by tick
  std::vector<ReadingSample> readings;           ///< in order of delivery; empty when not recorded
  std::vector<LightsSample> lights;              ///< by tick; empty if the world has none
  std::vector<ShapesSample> shapes;              ///< changes of objects' shapes, by time of the tick
  std::vector<base::FaultMark> faults;  ///< readings that faults affected, recorded or not, by time of the tick
  std::uint64_t ticks = 0;              ///< number of ticks in the file
  std::int64_t end_time = 0;            ///< [ns] simulated time of the last tick
  bool truncated = false;               ///< not finished: killed, or still being written; contains all whole ticks
  std::vector<std::string> damage;      ///< omitted data: checksum errors and unreadable messages
};

/// @param directory as passed to the recorder, or the path of an MCAP file
/// @throws base::InputError if there is no recording, the file has another origin, or its world is missing
Recording open_recording(const std::string& directory);

/// Reads a recording from memory. @param name of the file, for messages
Recording read_recording(std::span<const std::uint8_t> bytes, const std::string& name);

struct McapContents;
/// Returns the description of a recorded run, with its world. @param name of the file, for messages
/// @throws base::InputError if it is not a sensorfarm recording
RunInfo run_info_of(const McapContents& contents, const std::string& name);

}  // namespace sf::record
