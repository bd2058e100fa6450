#pragma once
// A sensor type: one table with everything that the farm, the wire, the recorder and the commands need.
//
// A new type x requires sensors/x.h, sensors/x.cpp (its SensorType), shaders/x.comp (physics), tests/sensors/x_test.cpp
// and `farm_sensor(<wire id> x DEVICE)` in sensors/CMakeLists.txt. If its kernel has records, add their header to
// shaders/CMakeLists.txt. A type without a kernel uses HOST and has no shader. Rays are horizontal
// (raycast/ray_caster.h).

#include <any>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bearing.h"
#include "base/bytes.h"
#include "base/echo.h"
#include "base/reading.h"
#include "base/report.h"
#include "base/rigid_transform.h"
#include "base/thread_pool.h"
#include "gpu/batch.h"
#include "gpu/device.h"
#include "raycast/sensor_context.h"
#include "world/world.h"

namespace sf::sensors {

using base::Pose;
using raycast::DueSample;
using raycast::SensorContext;
using raycast::SensorStats;

/// One accuracy mode of a sensor type.
struct AccuracyMode {
  std::string_view word;  ///< the value of `accuracy` in world files and on the command line
  std::string_view what;  ///< short description
};

/// Largest error of a sensor without noise, stated before a run.
struct ErrorBound {
  double error = 0.0;     ///< [unit of the first column] see base::ReadingBlock::bound_without_noise
  std::string condition;  ///< condition for the bound; empty: unconditional
};

/// One sensor of a world, in the form common to all types.
struct SensorSpec {
  std::uint32_t mover = 0;     ///< row in `World::movers`
  std::uint32_t sensor = 0;    ///< 0-based among the mover's sensors of this type
  std::string name;            ///< unique among the mover's sensors
  Pose X_MS;                   ///< sensor in the mover's frame
  double rate = 10.0;          ///< [Hz] > 0
  double phase = 0.0;          ///< [s] time of the first reading
  double latency = 0.0;        ///< [s] from measurement to delivery
  std::uint8_t priority = 5;   ///< 0 to 9: with a budget (farm/processor_budget.h), larger ones are measured first
  std::uint32_t elements = 1;  ///< rows of a reading: beams of a laser, elements of an array, words of a map, else 1
  std::uint32_t width = 0;     ///< numbers per row, those of its type's first columns; 0: all columns
  double limit = 0.0;          ///< largest value of an element, in the unit of its first column
  std::uint32_t across = 0;    ///< elements per row of an image; 0: the elements are not an image
  double pitch = 0.0;          ///< [m] side of an image's cell
  std::uint8_t mode = 0;       ///< row of its type's modes
  double fov = 0.0;            ///< [rad] of a scan (SensorType::is_scan)
  double sweep = 0.0;          ///< [s] of a rolling scan, from its first beam to its last one, or to its end
  double range_min = 0.0;      ///< [m] of ranges (laser, sonar, infrared); valid ranges end before `limit`

  // Dependencies of a reading other than its sequence number, for the farm's reading cache.
  double dependency_radius = 0.0;   ///< [m] > 0: the reading depends only on its own mover's pose and on the poses
                                    ///< within this radius. 0 disables reuse
  bool depends_on_magnets = false;  ///< the reading depends on the poses of all movers with magnets instead
  /// [unit of the first column] largest standard deviation of its noise; infinite: unknown. If positive, the reading
  /// also depends on noise, unless noise is off.
  double sigma = 0.0;
  /// [m] from the sensor: surfaces farther away have no effect on a reading. Infinite: any surface may have an effect.
  double reach = HUGE_VAL;
};

/// The sensors of one type in a world, parsed once, when the world's SensorSet is created.
struct ParsedSensors {
  std::vector<SensorSpec> rows;  ///< by mover and in file order
  std::any settings;  ///< a vector of further settings, one per row, in a form of the type's own; may be empty

  /// Returns the further settings. @pre `settings` holds a std::vector<Settings>
  template <class Settings>
  const std::vector<Settings>& settings_as() const {
    return std::any_cast<const std::vector<Settings>&>(settings);
  }
};

inline base::RangeLimits limits_of(const SensorSpec& sensor) { return {sensor.range_min, sensor.limit}; }

/// Returns the bearing of beam `i` of a scan in the sensor's frame [rad].
inline double bearing_of(const SensorSpec& sensor, std::uint32_t i) {
  return base::bearing_of(sensor.fov, sensor.elements, i);
}

/// Geometry of a spatial scan. The spans live as long as its ParsedSensors.
struct SpatialBeams {
  base::RigidTransform X_MS;               ///< sensor in the mover's frame
  std::span<const glm::dvec3> directions;  ///< unit vectors in the sensor's frame, one per beam
  std::span<const double> times;           ///< [s] <= 0, relative to the reading, one per beam; empty: all are 0
};

/// Returns the azimuth and the elevation [rad] of a beam's direction.
inline std::array<double, 2> angles_of(glm::dvec3 direction) {
  return {base::atan2(direction.y, direction.x), base::atan2(direction.z, base::hypot(direction.x, direction.y))};
}

/// All sensors of one type, computed as a batch. `SensorContext::states` holds the states of movers. Not thread-safe.
class SensorBackend {
 public:
  virtual ~SensorBackend() = default;

  /// Updates quantities that accumulate, such as wheel rotation. Called in each tick with its new
  /// `SensorContext::states`, even when nothing is due.
  /// @param now [ns]  @param between true: a sample between two ticks; the next tick continues from the last one
  virtual void accumulate(std::int64_t /*now*/, bool /*between*/) {}
  /// Moves surfaces and magnets of movers to their poses. Called before `prepare` when a sensor is measured. Absent
  /// movers are invisible.
  virtual void place_movers() {}
  /// Replaces the movers' outlines by those of `world`, the world of construction, which has changed. Readings of the
  /// last tick stay.  @return false: the farm must make another backend, which continues this one (`take_over`)
  virtual bool update_outlines(const world::World& /*world*/) { return false; }
  /// Does host work before the batch, even when nothing is due. @return true when the batch must be recorded again
  virtual bool prepare(std::span<const DueSample> due) = 0;
  /// Records the kernels that read the world (`record_measure`) and those that read their results (`record_derive`).
  /// The farm puts a barrier between the two.
  virtual void record_measure(gpu::Batch& batch) = 0;
  virtual void record_derive(gpu::Batch&) {}
  /// Adds this tick's copies to and from the device.
  virtual void add_copies(gpu::Batch& batch) = 0;
  /// Receives this tick's readings of all types that are not derived, before latency, for sensors that derive their
  /// readings from them (SensorType::derived_from). Called before `collect` whenever a sensor is due; may be empty.
  virtual void observe(std::span<const base::ReadingBlock>) {}
  /// Does host work after the batch: writes one block per due sensor, in order. The farm fills in time, sequence and
  /// X_WM. Spans of the blocks are valid until the next `prepare`.
  virtual void collect(std::span<base::ReadingBlock> out) = 0;
  /// Writes, or reads, the state of one sensor that its later readings depend on and that does not follow from poses
  /// and settings. Used by a process that continues this sensor. Empty by default. @param row among the world's sensors
  /// of this type
  virtual void write_state(std::uint32_t /*row*/, base::ByteWriter& /*out*/) const {}
  virtual void read_state(std::uint32_t /*row*/, base::ByteReader& /*in*/) {}
  /// Continues the sensors of `before`, its first `rows` rows, using the state from `write_state` and any state that
  /// exists only in this process. `before` must not be used afterwards.
  virtual void take_over(SensorBackend& before, std::uint32_t rows);
  /// Restarts a sensor: its mover begins an episode at `now` [ns], the time of the last tick, at its pose in
  /// `SensorContext::states`. Sensors without a state need not do anything.
  /// @throws base::InputError if the sensor cannot
  virtual void restart(std::uint32_t /*row*/, std::int64_t /*now*/) {}
  virtual SensorStats stats() const = 0;
  /// Returns true when the due readings need the farm's batch.
  virtual bool on_device() const { return true; }
};

/// One column of a reading. Values are stored row by row (element by element), with the columns of a row in sequence.
struct Column {
  std::string_view name;    ///< name in JSON and CSV, with its unit: `distance_m`
  std::uint32_t width = 1;  ///< count of numbers: 3 for a vector
  bool whole = false;       ///< an integer count
  int decimals = 0;         ///< in CSV; 0: as many as needed
};

/// Byte layout of readings: docs/packets.md, or the thesis' plain layout.
enum class WireFormat { farm, thesis };

/// Error of a payload.
enum class PayloadError { none, too_short, too_long, out_of_range };

/// Contents of one datagram of a reading.
struct PayloadPart {
  PayloadError fault = PayloadError::none;
  std::uint32_t elements = 0;  ///< in this part
  std::uint32_t part = 0;
  std::uint32_t parts = 1;
};

/// Packet types: the id of a sensor type (below 64), plus this offset for its extended form.
inline constexpr std::uint8_t kExtended = 64;

struct DerivedForm;

struct SensorType {
  std::uint8_t id = 0;                   ///< wire id, in [1, 63]
  std::string_view name;                 ///< name in commands, JSON and files, such as "laser"
  world::SensorKeyword word;             ///< keyword in world files
  world::SensorKeyword other_word = {};  ///< a second keyword; empty: none
  std::uint32_t base_port = 0;           ///< default of the first UDP port of its packets
  std::string_view list;                 ///< JSON name of the list of elements; empty: a reading is one row
  std::span<const Column> columns;
  bool is_scan = false;  ///< a reading is a planar scan: elements are beams, and the only column is their range [m].
                         ///< Recorded as a ROS LaserScan, printed with bearings
  /// Returns the beams of a type whose readings are spatial scans: elements are beams, and the first column is their
  /// range [m]. Null for all others.
  SpatialBeams (*beams)(const ParsedSensors& sensors, std::size_t row) = nullptr;
  std::uint8_t derived_from = 0;  ///< id of the type whose readings this type is computed from: `observe` is called,
                                  ///< and `collect` runs after theirs; 0: none

  const DerivedForm* derived = nullptr;  ///< computed from readings of other sensors (sensors/derived/derived_type.h);
                                         ///< null: measured

  std::span<const AccuracyMode> modes;  ///< the first is `exact`; empty: no other mode
  /// Returns the error bound of one sensor's readings without noise. Null: no bound is stated, neither here nor in
  /// readings.
  ErrorBound (*bound)(const world::World& world, const ParsedSensors& sensors, std::size_t row) = nullptr;

  /// Returns the standard deviation of the noise of one number of an element (own_noise in sensors/sensor_set.h). Null:
  /// SensorSpec::sigma for the first number, not stated for the others.
  /// @param offset index of the number in an element
  double (*noise)(const ParsedSensors& sensors, std::size_t row, std::uint32_t offset) = nullptr;

  /// Parses all sensors of this type. @throws base::InputError with file and line for invalid settings
  ParsedSensors (*parse)(const world::World& world);
  /// Creates the backend of a world with such sensors; null for derived types. @param sensors result of `parse`; must
  /// outlive the backend
  /// @throws base::DeviceError when the device cannot hold its tables
  std::unique_ptr<SensorBackend> (*make)(const SensorContext& context, const ParsedSensors& sensors);

  /// Returns the reason why `wire` cannot carry this sensor's readings, with a remedy; empty if it can.
  std::string (*wire_problem)(const SensorSpec& sensor, WireFormat wire);
  /// Returns the number of datagrams per reading.
  std::uint32_t (*parts)(const SensorSpec& sensor, WireFormat wire);
  /// Appends the payload of datagram `part`. Values outside the wire's range saturate and never wrap.
  /// @return its type; 0 when a value is NaN and nothing may be sent
  std::uint8_t (*encode)(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire,
                         std::uint32_t part, base::Bytes& out);
  /// Returns the largest difference between the first column of a reading and of its payloads in the farm's format, in
  /// the column's unit: half a step of the wire; infinite if a value saturates. Ignores words that are not numbers.
  /// Null for types without a bound.
  double (*wire_error)(const SensorSpec& sensor, const base::ReadingBlock& reading) = nullptr;
  /// Validates arbitrary bytes as a payload of this type.
  PayloadPart (*decode)(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                        WireFormat wire);
  /// Reads a payload that `decode` accepted. Writes this part's elements of `values`, which holds the whole reading as
  /// in a ReadingBlock. Values that the wire does not carry are left unchanged.
  void (*read)(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
               std::span<double> values) = nullptr;
};

/// Returns the number of values per element of a reading.
inline std::size_t element_width(const SensorType& type) {
  std::size_t width = 0;
  for (const Column& column : type.columns) width += column.width;
  return width;
}

/// Returns the number of values per element of a sensor's readings.
inline std::size_t element_width(const SensorType& type, const SensorSpec& sensor) {
  return sensor.width != 0 ? sensor.width : element_width(type);
}

/// Implements `SensorType::make` for a backend that is constructed from these two.
template <class Made>
std::unique_ptr<SensorBackend> make_backend(const SensorContext& context, const ParsedSensors& sensors) {
  return std::make_unique<Made>(context, sensors);
}

/// Returns the farm's own sensor types, by id, generated from sensors/CMakeLists.txt.
std::span<const SensorType* const> built_in_sensor_types();
/// Returns the built-in and the added types, by id.
std::span<const SensorType* const> sensor_types();
/// Adds a type for the rest of the program (sensors/own_sensors.h). Do not call it while another thread looks up types.
/// @param type must live as long as the program; its id must be unused
void add_sensor_type(const SensorType* type);
/// @return null when no type has that id
const SensorType* find_sensor_type(std::uint8_t id);
/// Returns the sensor keywords of world files, for world::LoadOptions.
std::span<const world::SensorKeyword> world_file_words();

}  // namespace sf::sensors
