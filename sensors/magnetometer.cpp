#include "sensors/magnetometer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "base/elementary.h"
#include "base/random.h"
#include "sensors/accuracy.h"
#include "sensors/laser_modes.h"
#include "sensors/magnetic_field/magnetic_field.h"
#include "sensors/magnetic_field/truncation.h"
#include "sensors/magnetometer_modes.h"
#include "sensors/magnetometer_packets.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kMostLifted = 4096;  // bounds that are kept

/// One array of a world.
struct Array {
  const Magnetometer& settings;
  const SensorSpec& row;
  double height = 0.0;             ///< [m] of its origin in the world at load
  std::size_t values = 0;          ///< index of its first value
  FieldBound bound;                ///< largest bound of its elements, with all movers at their heights at load
  std::vector<glm::dvec2> facing;  ///< per element: its x axis in the sensor frame
};

double height_of(const SensorSpec& row, const world::World& world) {
  return world.movers[row.mover].X_WM.z + row.X_MS.z;
}

std::vector<Array> arrays_of(const world::World& world, const ParsedSensors& sensors) {
  std::vector<Array> arrays;
  std::size_t values = 0;
  for (const SensorSpec& row : sensors.rows) {
    const Magnetometer& settings = sensors.settings_as<Magnetometer>()[arrays.size()];
    Array& array = arrays.emplace_back(Array{settings, row, height_of(row, world), values, {}, {}});
    for (const Pose& X_SE : settings.X_SE) array.facing.push_back(base::rotate(X_SE.yaw, {1.0, 0.0}));
    values += kMagnetometerColumns * settings.X_SE.size();
  }
  return arrays;
}

/// Returns `p` in a frame whose x axis is `facing`, of unit length.
glm::dvec2 along(glm::dvec2 facing, glm::dvec2 p) { return {glm::dot(facing, p), base::cross(facing, p)}; }

bool any_magnitudes(const std::vector<Array>& arrays) {
  return std::any_of(arrays.begin(), arrays.end(), [](const Array& a) { return a.settings.magnitudes; });
}

/// The points of all arrays in one mode.
struct Wave {
  MagneticField field;
  std::vector<FieldPoint> places;
  std::vector<std::uint32_t> ends;  ///< per group
};

std::vector<world::Magnet> magnets_of_movers(const world::World& world) {
  std::vector<world::Magnet> magnets;
  for (const world::Mover& mover : world.movers)
    magnets.insert(magnets.end(), mover.magnets.begin(), mover.magnets.end());
  return magnets;
}

class Magnetometers : public SensorBackend {
 public:
  Magnetometers(const SensorContext& context, const ParsedSensors& sensors);

  void place_movers() override;
  /// Magnets of movers stay at half of their height.
  bool update_outlines(const world::World& world) override { return moving_magnets_ == magnets_of_movers(world); }
  bool prepare(std::span<const DueSample> due) override;
  void record_measure(gpu::Batch& batch) override {
    if (!on_device_) return;
    for (auto& [mode, wave] : waves_) wave.field.record(batch);
  }
  void add_copies(gpu::Batch& batch) override {
    for (auto& [mode, wave] : waves_) wave.field.add_copies(batch);
  }
  void collect(std::span<base::ReadingBlock> out) override;
  SensorStats stats() const override;
  bool on_device() const override { return on_device_; }

 private:
  void bound_errors();
  const FieldBound& lifted_bound(std::uint8_t mode, double height);
  FieldBound bound_of(const Array& array, double z);
  void add_places(const Array& array, const Pose& X_WS);
  void read(std::size_t i);

  const world::World& world_;
  base::ThreadPool& thread_pool_;
  std::span<const base::Report> states_;
  raycast::Episodes episodes_;
  bool noise_;
  bool on_device_;
  std::vector<Array> arrays_;
  std::map<std::uint8_t, Wave> waves_;  ///< by mode
  std::vector<DueSample> due_;
  std::vector<Pose> X_WS_;          ///< per due array
  std::vector<FieldBound> bounds_;  ///< per due array
  bool level_ = true;               ///< all movers with magnets are at their heights at load
  std::vector<double> magnets_z_;   ///< [m] heights of the movers that carry magnets, in this tick
  std::vector<double> load_z_;      ///< [m] the same at load
  std::vector<world::Magnet> moving_magnets_;
  std::map<std::uint8_t, double> cut_;  ///< [T] by mode: bound of the cut-off at any height
  /// By mode and height of an element, for this tick's heights of magnets.
  std::map<std::pair<std::uint8_t, double>, FieldBound> lifted_;
  std::vector<std::uint32_t> groups_;  ///< per due array: its first group in its wave
  std::vector<double> values_;         ///< [T] of all arrays
};

Magnetometers::Magnetometers(const SensorContext& context, const ParsedSensors& sensors)
    : world_(context.world),
      thread_pool_(context.thread_pool),
      states_(context.states),
      episodes_(context.episodes),
      noise_(context.noise),
      on_device_(!context.device.is_host()),
      arrays_(arrays_of(context.world, sensors)) {
  const bool magnitudes = any_magnitudes(arrays_);
  for (const Array& array : arrays_)
    if (!waves_.contains(array.row.mode))
      waves_.emplace(array.row.mode, Wave{{context.world, context.device, context.thread_pool, magnitudes,
                                           cutoff_of(context.world, array.row.mode)},
                                          {},
                                          {}});
  bound_errors();
  for (const world::Mover& mover : world_.movers)
    if (!mover.magnets.empty()) load_z_.push_back(mover.X_WM.z);
  magnets_z_ = load_z_;
  moving_magnets_ = magnets_of_movers(world_);
  if (!arrays_.empty()) values_.resize(arrays_.back().values + kMagnetometerColumns * arrays_.back().row.elements);
}

void Magnetometers::bound_errors() {
  std::map<std::pair<std::uint8_t, double>, FieldBound> known;
  for (Array& array : arrays_)
    for (const Pose& X_SE : array.settings.X_SE) {
      const double height = array.height + X_SE.z;
      const auto [at, is_new] = known.try_emplace({array.row.mode, height});
      if (is_new) at->second = field_bound(world_, array.row.mode, height);
      array.bound.include(at->second);
    }
}

void Magnetometers::place_movers() {
  for (auto& [mode, wave] : waves_) wave.field.place_movers(states_);
  std::size_t k = 0;
  bool moved = false;
  for (std::size_t m = 0; m < states_.size(); ++m) {
    if (world_.movers[m].magnets.empty()) continue;
    moved = moved || magnets_z_[k] != states_[m].X_WM.z;
    magnets_z_[k++] = states_[m].X_WM.z;
  }
  level_ = magnets_z_ == load_z_;
  if (moved || lifted_.size() > kMostLifted) lifted_.clear();
}

const FieldBound& Magnetometers::lifted_bound(std::uint8_t mode, double height) {
  const auto [at, is_new] = lifted_.try_emplace({mode, height});
  if (!is_new) return at->second;
  const auto [cut, is_new_cut] = cut_.try_emplace(mode);
  if (is_new_cut) cut->second = truncation_bound_at_any_height(world_, cutoff_of(world_, mode));
  return at->second = field_bound(world_, states_, cut->second, height);
}

/// Returns the bound of an array whose origin is at height `z` [m].
FieldBound Magnetometers::bound_of(const Array& array, double z) {
  if (z == array.height && level_) return array.bound;
  FieldBound bound;
  for (const Pose& X_SE : array.settings.X_SE) bound.include(lifted_bound(array.row.mode, z + X_SE.z));
  return bound;
}

SensorStats Magnetometers::stats() const {
  SensorStats work;
  for (const auto& [mode, wave] : waves_) work.dipoles += wave.field.dipoles();
  return work;
}

void Magnetometers::add_places(const Array& array, const Pose& X_WS) {
  Wave& wave = waves_.at(array.row.mode);
  const glm::dvec2 x_S = base::rotate(X_WS.yaw, {1.0, 0.0});
  groups_.push_back(static_cast<std::uint32_t>(wave.ends.size()));
  const auto& X_SE = array.settings.X_SE;
  for (std::size_t i = 0; i < X_SE.size(); ++i) {
    const glm::dvec2 p{x_S.x * X_SE[i].x - x_S.y * X_SE[i].y, x_S.y * X_SE[i].x + x_S.x * X_SE[i].y};
    wave.places.push_back({X_WS.x + p.x, X_WS.y + p.y, X_WS.z + X_SE[i].z});
    const bool full = (i + 1) % SF_FIELD_POINTS == 0 || i + 1 == X_SE.size();
    if (full) wave.ends.push_back(static_cast<std::uint32_t>(wave.places.size()));
  }
}

bool Magnetometers::prepare(std::span<const DueSample> due) {
  due_.assign(due.begin(), due.end());
  X_WS_.clear(), bounds_.clear();
  groups_.clear();
  for (auto& [mode, wave] : waves_) wave.places.clear(), wave.ends.clear();
  for (const DueSample& d : due_) {
    const Array& array = arrays_[d.row];
    X_WS_.push_back(base::compose(states_[array.row.mover].X_WM, array.row.X_MS));
    bounds_.push_back(bound_of(array, X_WS_.back().z));
    add_places(array, X_WS_.back());
  }
  bool again = false;
  for (auto& [mode, wave] : waves_) again |= wave.field.prepare(wave.places, wave.ends);
  return again;
}

void Magnetometers::read(std::size_t i) {
  const DueSample& due = due_[i];
  const Array& array = arrays_[due.row];
  const Magnetometer& m = array.settings;
  const base::RandomKey draw =
      episodes_.key(base::RandomStream::field_noise, array.row.mover, array.row.sensor, due.sequence);
  const MagneticField& field = waves_.at(array.row.mode).field;
  const glm::dvec2 facing = base::rotate(X_WS_[i].yaw, {1.0, 0.0});
  for (std::uint32_t e = 0; e < m.X_SE.size(); ++e) {
    const FieldSum sum = field.at(groups_[i] + e / SF_FIELD_POINTS, e % SF_FIELD_POINTS);
    const glm::dvec2 b_S = along(facing, {sum.x, sum.y});
    const glm::dvec2 b_E = along(array.facing[e], b_S);
    std::array<double, 3> b{b_E.x, b_E.y, sum.z};
    double extra = 0.0;
    if (noise_ && m.sigma > 0.0) {
      const auto xy = base::random_normal(draw, 2 * e);
      const auto zf = base::random_normal(draw, 2 * e + 1);
      b = {b[0] + m.sigma * xy[0], b[1] + m.sigma * xy[1], b[2] + m.sigma * zf[0]};
      extra = m.sigma * zf[1];
    }
    const double total = m.magnitudes ? sum.magnitudes + extra : base::hypot(b[0], b[1], b[2]);
    double* const out = values_.data() + array.values + kMagnetometerColumns * e;
    out[0] = std::clamp(total, m.least, m.most);
    for (std::size_t k = 0; k < 3; ++k) out[k + 1] = std::clamp(b[k], m.least, m.most);
  }
}

void Magnetometers::collect(std::span<base::ReadingBlock> out) {
  for (auto& [mode, wave] : waves_)
    if (!on_device_ && !due_.empty()) wave.field.sum_on_host();
  thread_pool_.parallel_for_each(due_.size(), 64, [this](std::size_t i, unsigned) { read(i); });
  for (std::size_t i = 0; i < due_.size(); ++i) {
    const Array& array = arrays_[due_[i].row];
    base::ReadingBlock block;
    block.mover = array.row.mover;
    block.sensor = array.row.sensor;
    block.type = kMagnetometer;
    block.X_WS = X_WS_[i];
    block.values =
        std::span<const double>(values_).subspan(array.values, kMagnetometerColumns * array.settings.X_SE.size());
    block.mode = array.row.mode;
    block.bound = block.bound_without_noise =
        bounds_[i].at(std::max(std::abs(block.X_WS.x), std::abs(block.X_WS.y)) + 1.0);
    out[i] = block;
  }
}

ParsedSensors parse_magnetometers(const world::World& world) {
  std::vector<SensorSpec> rows;
  std::vector<Magnetometer> magnetometers;
  const auto type = magnetometer_type.word.type;
  for_each_of(world, type, [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number) {
    const Magnetometer& m = magnetometers.emplace_back(read_magnetometer(sensor));
    SensorSpec& row = rows.emplace_back(common_spec(sensor, mover, number));
    row.mode = mode_of("magnetometer", kMagnetometerModes, accuracy_of(sensor), world);
    row.X_MS.z += sensor.height / 2.0;
    row.elements = static_cast<std::uint32_t>(m.X_SE.size());
    row.limit = std::max(std::abs(m.least), std::abs(m.most));
    // The order in which moving magnets are summed depends on all of their positions.
    row.dependency_radius = HUGE_VAL;
    row.depends_on_magnets = true;
    row.reach = 0.0;
    row.sigma = m.sigma;
  });
  return {std::move(rows), std::move(magnetometers)};
}

ErrorBound bound_of_magnetometer(const world::World& world, const ParsedSensors& sensors, std::size_t at) {
  const SensorSpec& row = sensors.rows[at];
  std::set<double> heights;
  for (const Pose& X_SE : sensors.settings_as<Magnetometer>()[at].X_SE) heights.insert(height_of(row, world) + X_SE.z);
  const double farthest = reaches_of(world).farthest + 1.0;
  ErrorBound bound;
  for (const double height : heights)
    bound.error = std::max(bound.error, field_bound(world, row.mode, height).at(farthest));
  if (std::isinf(bound.error))
    bound.condition = "a magnet is at the sensor's height, so the sensor can reach its centre";
  return bound;
}

constexpr std::string_view kKeys[] = {"scount", "spose[]", "spose3[]", "ssensitivity", "ssize", "sum", "noise"};
constexpr Column kColumns[] = {{"field_T"}, {"vector_T", 3}};

}  // namespace

constinit const SensorType magnetometer_type{
    .id = kMagnetometer,
    .name = "magnetometer",
    .word = {"magnetometer", kKeys},
    .base_port = 30000,
    .list = "sensors",
    .columns = kColumns,
    .modes = kMagnetometerModes,
    .bound = bound_of_magnetometer,
    .parse = parse_magnetometers,
    .make = make_backend<Magnetometers>,
    .wire_problem = magnetometer_wire_problem,
    .parts = magnetometer_parts,
    .encode = encode_magnetometer,
    .wire_error = magnetometer_wire_error,
    .decode = decode_magnetometer,
    .read = read_magnetometer_payload,
};

}  // namespace sf::sensors
