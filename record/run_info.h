#pragma once
// Description of a run. With the world and the states, it suffices to recompute all scans.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/pose.h"
#include "maps/grid.h"

namespace sf::record {

/// One column of a sensor type's readings.
struct ColumnInfo {
  std::string name;         ///< with its unit, e.g. `distance_m`
  std::uint32_t width = 1;  ///< numbers per element: 3 for a vector
  bool whole = false;       ///< counts, in [0, 2^32 - 1]
};

/// A sensor type: the format of its readings.
struct SensorTypeInfo {
  std::uint8_t id = 0;              ///< `base::ReadingBlock::type`
  std::string name;                 ///< one word of lower-case letters and digits
  std::string list;                 ///< name of its elements; empty: a reading is one row
  std::vector<ColumnInfo> columns;  ///< the values of a reading are element by element, in each in order of columns
  bool is_scan = false;             ///< readings are planar scans, recorded as sensor_msgs/LaserScan
};

/// An element of a sensor whose readings are told as a standard ROS message, too, which viewers and drivers know.
struct StandardTopic {
  enum class Message : std::uint8_t { range, magnetic_field, fix, imu, map };
  Message message = Message::range;
  std::uint32_t element = 0;  ///< of the reading
  std::string topic;          ///< set by `name_frames`, as `frame`
  std::string frame;          ///< equal to the sensor's for a sensor of one element; of maps `world`
  base::Pose X_SE;            ///< element in the sensor's frame

  // Ranges.
  bool infrared = false;   ///< false: ultrasound
  double fov = 0.0;        ///< [rad] aperture of the cone
  double range_min = 0.0;  ///< [m]
  double range_max = 0.0;  ///< [m]

  maps::GridGeometry grid;  ///< of maps

  /// Standard deviation of a turn rate [rad/s], of a fix [m] at an HDOP of 1; 0: none is stated.
  double sigma = 0.0;
};

struct SensorInfo {
  std::uint8_t type = 0;  ///< id of a row of `RunInfo::sensor_types`
  std::string name;
  std::string topic;   ///< of its readings; set by `name_frames`, as `frame`
  base::Pose X_MS;     ///< sensor in the mover's frame
  double rate = 10.0;  ///< [Hz] > 0
  double fov = 0.0;    ///< [rad] of scans, as all below
  std::uint32_t samples = 0;
  double range_min = 0.0;               ///< [m]
  double range_max = 0.0;               ///< [m]
  std::vector<StandardTopic> standard;  ///< not read back, since the world has them
  std::string frame;                    ///< not read back
};

/// Wheel encoders, as far as their robot knows them.
struct EncoderInfo {
  std::uint8_t type = 0;    ///< id of a row of `RunInfo::sensor_types`: the first columns are left_m and right_m
  double per_count = 1e-3;  ///< [m] that a wheel rolls per count
  double slip = 0.0;        ///< [m^(1/2)] standard deviation of a wheel's counted way after one metre
  double track = 0.3;       ///< [m] > 0 between the wheels
};

/// Surfaces as lines at their upper ends, in one colour.
struct Outline {
  std::string name;
  std::uint32_t color = 0xFF808080u;  ///< 0xAARRGGBB
  std::vector<glm::dvec3> ends;       ///< [m] two per segment
};

/// Walls as viewers show them; not read back, since the world has them.
struct WorldShape {
  std::vector<Outline> walls;  ///< by model, in the world frame; empty: too many to be shown, or none
  double cell = 0.05;          ///< [m] of `occupied`
  glm::dvec2 corner;           ///< [m] lower left of its first cell
  std::uint32_t columns = 0;   ///< along x; 0: no map
  std::uint32_t rows = 0;      ///< along y
  std::vector<bool> occupied;  ///< cells that a wall passes, row by row from the corner
};

struct MoverInfo {
  std::string name;                 ///< as in the world
  std::string frame;                ///< its name as ROS allows it, unique in the run; set by `name_frames`
  std::uint32_t id = 0;             ///< id in packets
  std::vector<SensorInfo> sensors;  ///< those of one type in the order of `base::ReadingBlock::sensor`

  // Not read back, since the world has it, or `name_frames` sets it.
  std::vector<Outline> body;  ///< in its frame
  std::string space;          ///< in front of its topics: "/robot", or empty
  std::string base_frame;     ///< of the mover itself: "robot/base_link"
  std::string odom_frame;     ///< that its odometry is in
  bool tag = false;           ///< no node elsewhere localizes it
  bool plain = false;         ///< with TopicStyle::plain: the robot without a namespace
  double max_forward = std::numeric_limits<double>::infinity();  ///< [m/s]
  std::optional<EncoderInfo> encoder;                            ///< the first ones
};

/// A robot that joined the run: a copy of an earlier row, appended to the world's movers.
struct JoinedMover {
  std::uint32_t original = 0;  ///< row of the mover that it copies
  std::string name;
  base::Pose X_WM;  ///< where it joined
};

struct RunInfo {
  std::string world;  ///< name
  std::uint64_t world_hash = 0;
  std::uint64_t seed = 0;
  std::string mode = "exact";
  double interval = 0.1;  ///< [s] simulated time per tick
  bool record_readings = false;
  bool estimated = false;      ///< states are estimates from messages, recorded with their quality
  double odometry_rate = 1.0;  ///< [Hz] of the Odometry and TwistStamped messages; 0: none; states come every tick
  std::vector<SensorTypeInfo> sensor_types;                  ///< types of the movers' sensors
  std::vector<MoverInfo> movers;                             ///< in the rows of `base::Report::mover`
  std::vector<std::pair<std::string, std::string>> options;  ///< further options of the run
  std::vector<std::string> accuracy;  ///< JSON objects: error bounds of its readings; not read back, for readers alone
  base::Bytes snapshot;               ///< the world, not empty
  std::vector<JoinedMover> joined;    ///< of `movers`, the last rows: in the order in which they joined the snapshot's
  WorldShape shape;
  std::vector<std::string> lights;  ///< names of the world's traffic lights; not read back, since the world has them
};

/// Options of a run, in the words of the command line.
inline constexpr std::string_view kNoReturn = "no_return";  ///< "max" or "inf"
/// "min": ranges of surfaces that are too near are range_min in messages. Absent: they are -infinity, or the recording
/// is of a version without this option, which has range_min.
inline constexpr std::string_view kTooNear = "too_near";
/// Value of an option; empty where the run has none of that name.
std::string_view option_of(const RunInfo& info, std::string_view key);

/// @return null when the run has no sensors of that type.
const SensorTypeInfo* find_sensor_type(const RunInfo& info, std::uint8_t id);

/// `sensorfarm_msgs/msg/RunInfo`, without the snapshot. Sensors with scans are its `sensorfarm_msgs/Laser` rows, which
/// name no type: a run has at most one type of scans, which is read back as type 1, `laser`.
void encode_run_info(const RunInfo& info, base::Bytes& out);
/// @returns false when the bytes are not a RunInfo message; `info` is then partly filled.
bool decode_run_info(std::span<const std::uint8_t> message, RunInfo& info);

}  // namespace sf::record
