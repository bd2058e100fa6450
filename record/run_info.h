#pragma once
// Description of a run. Together with the world and the states, it suffices to recompute all scans.

#include <cstdint>
#include <glm/ext/matrix_double3x3.hpp>
#include <glm/ext/vector_double3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/lens.h"
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
  std::vector<ColumnInfo> columns;  ///< the values of a reading are ordered by element, then by column
  bool is_scan = false;             ///< readings are planar scans, recorded as sensor_msgs/LaserScan
};

/// An element of a sensor whose readings are also published as standard ROS messages, for viewers and drivers.
struct StandardTopic {
  enum class Message : std::uint8_t {
    range,
    magnetic_field,
    fix,
    imu,
    map,
    points,
    radar_scan,
    depth_image,
    color_image,
    depth_png,
    color_file,
    camera_info
  };
  Message message = Message::range;
  std::uint32_t element = 0;  ///< index in the reading
  std::string topic;          ///< set by `name_frames`, like `frame`
  std::string frame;          ///< the sensor's own for a sensor with one element; `world` for maps
  base::Pose X_SE;            ///< element in the sensor's frame
  base::Tilt tilt;            ///< of the element after X_SE

  // For ranges:
  bool infrared = false;   ///< false: ultrasound
  double fov = 0.0;        ///< [rad] aperture of the cone
  double range_min = 0.0;  ///< [m]
  double range_max = 0.0;  ///< [m]

  maps::GridGeometry grid;  ///< for maps

  // For points, of which an element is the whole reading:
  std::shared_ptr<const std::vector<glm::dvec3>> directions;  ///< unit vectors of the beams in frame `frame`
  std::uint32_t rings = 1;                                    ///< rows of the cloud, of equal length
  std::size_t width = 1;  ///< numbers per beam: the range, the intensity, ...; per pixel: the depth, the colour, ...
  std::shared_ptr<const std::vector<double>> times;  ///< [s] of the beams relative to the reading; null: 0

  // For images and CameraInfo, of which an element is the whole reading. X_SE is the optical frame (REP 103).
  std::uint32_t columns = 0, rows = 0;  ///< [px]
  base::Lens lens;
  bool mono = false;  ///< colours are grey
  int jpeg = 0;       ///< quality of files of colours, in [1, 100]; 0: PNG

  // For readings in three dimensions: of an imu, a compass or a radar, whose vectors are turned into frame `frame`,
  // which is level on a level robot, and of a receiver with an altitude:
  bool spatial = false;      ///< false: of a gyro, of a magnetometer, without altitude
  glm::dmat3 R_FS{1.0};      ///< sensor in this frame
  double force_sigma = 0.0;  ///< [m/s^2] of each axis; 0: not stated

  /// Standard deviation of a turn rate [rad/s], of a field [T], or of a fix [m] at an HDOP of 1; 0: not stated.
  double sigma = 0.0;
};

/// The messages with the images of cameras.
struct ImageMessages {
  enum class Files : std::uint8_t { camera, png, jpeg };
  bool compressed = true, raw = false;  ///< CompressedImage, Image
  Files files = Files::camera;          ///< of colours; camera: JPEG of those that ask for it, else PNG
};

struct SensorInfo {
  std::uint8_t type = 0;  ///< id of a row of `RunInfo::sensor_types`
  std::string name;
  std::string topic;   ///< topic of its readings; set by `name_frames`, like `frame`
  base::Pose X_MS;     ///< sensor in the mover's frame
  double rate = 10.0;  ///< [Hz] > 0
  double fov = 0.0;    ///< [rad] for scans, like all fields below
  std::uint32_t samples = 0;
  double range_min = 0.0;               ///< [m]
  double range_max = 0.0;               ///< [m]
  std::size_t width = 0;                ///< as for `encode_reading`; not read back
  double sweep = 0.0;                   ///< [s] of a rolling scan; not read back
  std::vector<StandardTopic> standard;  ///< not read back, since the world contains them
  std::string frame;                    ///< not read back
  base::Tilt tilt;                      ///< of the plane of a scan, after X_MS; not read back
};

/// Wheel encoders, with the parameters that the robot assumes.
struct EncoderInfo {
  std::uint8_t type = 0;    ///< id of a row of `RunInfo::sensor_types`: the first columns are left_m and right_m
  double per_count = 1e-3;  ///< [m] distance that a wheel rolls per count
  double slip = 0.0;        ///< [m^(1/2)] standard deviation of a wheel's counted distance after one metre
  double track = 0.3;       ///< [m] > 0 distance between the wheels
};

/// Surfaces as lines along their upper edges, in one colour.
struct Outline {
  std::string name;
  std::uint32_t color = 0xFF808080u;  ///< 0xAARRGGBB
  std::vector<glm::dvec3> ends;       ///< [m] two per segment
};

/// Walls as displayed by viewers. Not read back, since the world contains them.
struct WorldShape {
  std::vector<Outline> walls;  ///< by model, in the world frame; empty: none, or too many to display
  double cell = 0.05;          ///< [m] cell size of `occupied`
  glm::dvec2 corner;           ///< [m] lower left corner of its first cell
  std::uint32_t columns = 0;   ///< along x; 0: no map
  std::uint32_t rows = 0;      ///< along y
  std::vector<bool> occupied;  ///< cells that a wall crosses, row by row from the corner
};

struct MoverInfo {
  std::string name;                 ///< name in the world
  std::string frame;                ///< its name in the form that ROS allows, unique in the run; set by `name_frames`
  std::uint32_t id = 0;             ///< id in packets
  std::vector<SensorInfo> sensors;  ///< sensors of one type are in the order of `base::ReadingBlock::sensor`

  // Not read back, since the world contains it, or `name_frames` sets it.
  std::vector<Outline> body;  ///< in its frame
  std::string space;          ///< prefix of its topics: "/robot", or empty
  std::string base_frame;     ///< frame of the mover itself: "robot/base_link"
  std::string odom_frame;     ///< frame of its odometry
  bool tag = false;           ///< no external node localizes it
  bool plain = false;         ///< with TopicStyle::plain: the robot without a namespace
  double max_forward = std::numeric_limits<double>::infinity();  ///< [m/s]
  std::optional<EncoderInfo> encoder;                            ///< the first encoders
};

/// A robot that joined the run: a copy of an earlier row, appended to the world's movers.
struct JoinedMover {
  std::uint32_t original = 0;  ///< row of the mover that it copies
  std::string name;
  base::Pose X_WM;  ///< pose where it joined
};

struct RunInfo {
  std::string world;  ///< name
  std::uint64_t world_hash = 0;
  std::uint64_t seed = 0;
  std::string mode = "exact";
  double interval = 0.1;  ///< [s] simulated time per tick
  bool record_readings = false;
  bool estimated = false;      ///< states are estimates from messages, recorded with their quality
  double odometry_rate = 1.0;  ///< [Hz] rate of the Odometry and TwistStamped messages; 0: none; states are recorded
                               ///< every tick
  std::vector<SensorTypeInfo> sensor_types;                  ///< types of the movers' sensors
  std::vector<MoverInfo> movers;                             ///< indexed by `base::Report::mover`
  std::vector<std::pair<std::string, std::string>> options;  ///< further options of the run
  std::vector<std::string> accuracy;  ///< JSON objects with the error bounds of its readings; not read back, for
                                      ///< readers of the file
  base::Bytes snapshot;               ///< the world, not empty
  std::vector<JoinedMover> joined;    ///< the last rows of `movers`, in the order in which they joined
  WorldShape shape;
  std::vector<std::string> lights;  ///< names of the world's traffic lights; not read back, since the world contains
                                    ///< them
};

/// Options of a run, with the words of the command line.
inline constexpr std::string_view kNoReturn = "no_return";  ///< "max" or "inf"
/// "min": ranges of surfaces that are too near are range_min in messages. Absent: they are -infinity, or range_min in
/// recordings of versions without this option.
inline constexpr std::string_view kTooNear = "too_near";
/// Faults of sensors, as [[fault]] tables of a scenario. Absent: none.
inline constexpr std::string_view kFaultsOption = "faults";
/// Returns the value of an option; empty if the run has no option of that name.
std::string_view option_of(const RunInfo& info, std::string_view key);

/// @return null if the run has no sensors of that type
const SensorTypeInfo* find_sensor_type(const RunInfo& info, std::uint8_t id);

/// Encodes `sensorfarm_msgs/msg/RunInfo`, without the snapshot. Sensors with scans are its `sensorfarm_msgs/Laser`
/// rows, which do not contain a type: a run has at most one type of scans, which is read back as type 1, `laser`.
void encode_run_info(const RunInfo& info, base::Bytes& out);
/// @return false if the bytes are not a RunInfo message; `info` is then partly filled
bool decode_run_info(std::span<const std::uint8_t> message, RunInfo& info);

}  // namespace sf::record
