#pragma once
// A kind of sensor: all that the farm, the wire, the recorder and the commands know of it, as one table.
//
// A new kind x is four files and one line: sensors/x.h (records that host and device share), sensors/x.cpp (its
// SensorKind), shaders/x.comp (physics), tests/sensors/x_test.cpp (proof), and `farm_sensor(<wire id> x DEVICE)` in
// sensors/CMakeLists.txt.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/reading.h"
#include "base/report.h"
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

/// One way a kind can measure.
struct AccuracyMode {
  std::string_view word;  ///< in world files, after `accuracy`, and on the command line
  std::string_view what;  ///< it does, in a few words
};

/// How wrong a sensor may be, stated before it measures.
struct ErrorBound {
  double error = 0.0;     ///< [unit of the first column] see base::ReadingBlock::bound
  std::string condition;  ///< where it holds; empty: everywhere
};

/// One sensor of a world, as every module but its own kind sees it.
struct SensorSpec {
  std::uint32_t mover = 0;     ///< row in `World::movers`
  std::uint32_t sensor = 0;    ///< 0-based among the mover's sensors of this kind
  std::string name;            ///< unique among the mover's sensors
  Pose X_MS;                   ///< sensor in the mover's frame
  double rate = 10.0;          ///< [Hz] > 0
  double phase = 0.0;          ///< [s] time of the first reading
  double latency = 0.0;        ///< [s] from measurement to delivery
  std::uint32_t elements = 1;  ///< rows of a reading: beams of a laser, elements of an array, else 1
  double limit = 0.0;          ///< largest value an element gives, in the unit of its first column
  std::uint32_t across = 0;    ///< elements that lie in rows make a picture: so many in a row; 0: they do not
  double pitch = 0.0;          ///< [m] of such a picture: side of its smallest square
  std::uint8_t mode = 0;       ///< row of its kind's modes

  // What a reading depends on beside its number, so that the farm may give one again.
  double dependency_radius =
      0.0;  ///< [m] > 0: on its mover's pose, to the bit, and on the poses of those within it. 0: on more
  bool depends_on_magnets = false;  ///< on those that carry magnets, wherever they are, instead
  bool noisy = false;               ///< on noise, too, unless that is off
};

/// All sensors of one kind, a batch at a time. One thread.
class SensorBackend {
 public:
  virtual ~SensorBackend() = default;

  /// Takes every mover's state, one per mover, each tick, whether something is due or not: for what adds up over time
  /// (wheels) or is told by the mover (what touches it). @param now [ns] @param between two ticks, for readings alone:
  /// the next tick goes on from the last one.
  virtual void update_states(std::span<const base::Report>, std::int64_t /*now*/, bool /*between*/) {}
  /// Takes this tick's poses, one per mover, before `prepare`, when something is due. A mover whose x is not a number
  /// is gone, and nobody senses it.
  virtual void set_poses(std::span<const Pose>) {}
  /// Host work before the batch, also when nothing is due. @return true when the batch must be recorded again.
  virtual bool prepare(std::span<const DueSample> due, std::span<const Pose> poses) = 0;
  /// Kernels that read the world, then those that read what these wrote: a barrier lies between.
  virtual void record_measure(gpu::Batch& batch) = 0;
  virtual void record_derive(gpu::Batch&) {}
  /// This tick's copies, up and down.
  virtual void add_copies(gpu::Batch& batch) = 0;
  /// What other kinds measured this tick, before latency, of heard movers: for kinds that are made of others' readings
  /// (SensorKind::derived), every tick in which there is any, before `collect`.
  virtual void observe(std::span<const base::ReadingBlock>) {}
  /// Host work after the batch: appends one block per due sensor, in order. The farm fills in time, sequence and X_WM.
  /// Spans live until the next `prepare`.
  virtual void collect(std::vector<base::ReadingBlock>& out) = 0;
  virtual SensorStats stats() const = 0;
  /// Whether the farm's batch is needed for what is due.
  virtual bool on_device() const { return true; }
};

/// One column of a reading. A reading's values lie row by row (element by element), its columns one after another.
struct Column {
  std::string_view name;    ///< as in JSON and CSV, with its unit: `distance_m`
  std::uint32_t width = 1;  ///< numbers: 3 for a vector
  bool whole = false;       ///< counts things
};

/// Which bytes readings are sent as: docs/packets.md, or the thesis' plain layout.
enum class WireFormat { farm, thesis };

/// What is wrong with a payload.
enum class PayloadError { none, too_short, too_long, out_of_range };

/// What one datagram of a reading holds.
struct PayloadPart {
  PayloadError fault = PayloadError::none;
  std::uint32_t elements = 0;  ///< in this part
  std::uint32_t part = 0;
  std::uint32_t parts = 1;
};

/// Types on the wire: a kind's own id (below 64), or this much more for its second form.
inline constexpr std::uint8_t kExtended = 64;

struct SensorType {
  std::uint8_t id = 0;          ///< on the wire, in [1, 31]
  std::string_view name;        ///< the word for it everywhere, e.g. "laser"
  world::SensorKeyword word;    ///< in world files; empty for the kind that world reads itself
  std::uint32_t base_port = 0;  ///< of its packets, unless told otherwise
  std::string_view list;        ///< JSON name of the list of elements; empty: a reading is one row
  std::span<const Column> columns;
  bool derived = false;  ///< made of other kinds' readings: its `observe` is called, and it is collected after them

  std::span<const AccuracyMode> modes;  ///< the first is `exact`; empty: it has no other
  /// The error bound of one sensor's readings. Null: none is stated, here and with each reading.
  ErrorBound (*bound)(const world::World& world, const SensorSpec& sensor) = nullptr;

  /// Every sensor of this kind, by mover and in file order.
  /// @throws base::InputError with file and line for settings that it cannot have.
  std::vector<SensorSpec> (*specs)(const world::World& world);
  /// For a world that has some. @throws base::DeviceError when the device cannot hold its tables.
  std::unique_ptr<SensorBackend> (*make)(const SensorContext& context);

  /// Why `wire` cannot carry this sensor's readings and what to do; empty when it can.
  std::string (*wire_problem)(const SensorSpec& sensor, WireFormat wire);
  /// Datagrams of one reading.
  std::uint32_t (*parts)(const SensorSpec& sensor, WireFormat wire);
  /// Appends the payload of datagram `part`. Values that the wire cannot hold saturate, never wrap.
  /// @return its type, or 0 when a value is not a number and nothing may be sent.
  std::uint8_t (*encode)(const SensorSpec& sensor, const base::ReadingBlock& reading, WireFormat wire,
                         std::uint32_t part, base::Bytes& out);
  /// Judges any bytes that claim to be such a payload.
  PayloadPart (*decode)(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type,
                        WireFormat wire);
  /// Fills in what a payload says that `decode` found no fault with: `values` are the whole reading's, as in a
  /// ReadingBlock, of which this part's elements are written. What the wire does not carry stays as it is.
  void (*read)(const SensorSpec& sensor, std::span<const std::uint8_t> payload, std::uint8_t type, WireFormat wire,
               std::span<double> values) = nullptr;
};

/// Numbers in one element of a reading.
inline std::size_t element_width(const SensorType& kind) {
  std::size_t width = 0;
  for (const Column& column : kind.columns) width += column.width;
  return width;
}

/// What a kind's `make` is where its instruments need the site alone.
template <class Made>
std::unique_ptr<SensorBackend> make_backend(const SensorContext& context) {
  return std::make_unique<Made>(context);
}

/// Every kind there is, by id: generated from sensors/CMakeLists.txt.
std::span<const SensorType* const> sensor_types();
/// @return null when no kind has that id.
const SensorType* find_sensor_type(std::uint8_t id);
/// What world files may call sensors: for world::LoadOptions.
std::span<const world::SensorKeyword> world_file_words();

}  // namespace sf::sensors
