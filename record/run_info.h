#pragma once
// What a run was made of: with the world and the states, enough to compute every scan again.

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/pose.h"

namespace sf::record {

struct LaserInfo {
  std::string name;
  std::string topic;  ///< of its scans; set by the recorder
  base::Pose X_MS;    ///< sensor in the mover's frame
  double fov = 0.0;   ///< [rad]
  std::uint32_t samples = 0;
  double range_min = 0.0;  ///< [m]
  double range_max = 0.0;  ///< [m]
  double rate = 10.0;      ///< [Hz] > 0
};

/// One column of a kind's readings.
struct ColumnInfo {
  std::string name;         ///< with its unit, e.g. `distance_m`
  std::uint32_t width = 1;  ///< numbers: 3 for a vector
  bool whole = false;       ///< counts things, in [0, 2^32 - 1]
};

/// A kind of sensor, lasers aside: what its readings' numbers are.
struct SensorTypeInfo {
  std::uint8_t id = 0;              ///< `base::ReadingBlock::kind`
  std::string name;                 ///< one word of lower-case letters and digits
  std::string list;                 ///< what its elements are called; empty: a reading is one row
  std::vector<ColumnInfo> columns;  ///< a reading's values lie element by element, column after column
};

/// A sensor of such a kind.
struct SensorInfo {
  std::uint8_t kind = 0;  ///< id of a row of `RunInfo::sensor_types`
  std::string name;
  std::string topic;   ///< of its readings; set by the recorder
  base::Pose X_MS;     ///< sensor in the mover's frame
  double rate = 10.0;  ///< [Hz] > 0
};

struct MoverInfo {
  std::string name;                 ///< as in the world
  std::string frame;                ///< its name as ROS allows it, unique in the run; set by the recorder
  std::uint32_t id = 0;             ///< number on the wire
  std::vector<LaserInfo> lasers;    ///< in the order of `base::ReadingBlock::sensor`
  std::vector<SensorInfo> sensors;  ///< of all other kinds, those of one kind in that order
};

struct RunInfo {
  std::string world;  ///< name
  std::uint64_t world_hash = 0;
  std::uint64_t seed = 0;
  std::string mode = "exact";
  double interval = 0.1;  ///< [s] simulated time per tick
  bool record_readings = false;
  double odometry_rate = 1.0;  ///< [Hz] of the Odometry and TwistStamped messages; 0: none; states come every tick
  std::vector<SensorTypeInfo> sensor_types;                  ///< that movers have sensors of
  std::vector<MoverInfo> movers;                             ///< in the rows of `base::Report::mover`
  std::vector<std::pair<std::string, std::string>> options;  ///< whatever else a run was told
  base::Bytes snapshot;                                      ///< the world, not empty
};

/// @return null when the run has no sensors of that kind.
const SensorTypeInfo* find_sensor_type(const RunInfo& info, std::uint8_t id);

/// Gives every mover a frame and every sensor a topic: names with all but [A-Za-z0-9_] turned to '_', made unique.
void name_frames(RunInfo& info);

/// `sensorfarm_msgs/msg/RunInfo`, all but the snapshot.
void encode_run_info(const RunInfo& info, base::Bytes& out);
/// @returns false when the bytes are no RunInfo; `info` is then half filled.
bool decode_run_info(std::span<const std::uint8_t> message, RunInfo& info);

}  // namespace sf::record
