#include "sensors/own_backend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>

#include "base/error.h"
#include "base/plugin_calls.h"
#include "base/printable.h"
#include "base/random.h"
#include "sensors/derived/public_types.h"
#include "sensors/own_kernel.h"
#include "sensors/own_surroundings.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

/// View of the surroundings during one measurement.
class SensorSurroundings final : public sensorfarm::Surroundings {
 public:
  /// @param mover that carries the sensor, in whose world it is
  SensorSurroundings(const OwnSurroundings& surroundings, std::uint32_t mover, const base::RandomKey& key, bool noise)
      : surroundings_(surroundings),
        states_(surroundings.states_with(mover)),
        mover_(mover),
        key_(key),
        noise_(noise) {}
  sensorfarm::Hit cast(double x, double y, double z, double bearing, double range) const override {
    return surroundings_.cast(mover_, {x, y, z, bearing}, range);
  }
  std::size_t robots() const override { return states_.size(); }
  sensorfarm::Pose pose(std::size_t row) const override { return public_pose(states_[row].X_WM); }
  sensorfarm::Twist velocity(std::size_t row) const override { return public_twist(states_[row].velocity); }
  std::array<double, 2> normal(std::uint32_t draw) const override {
    return noise_ ? base::random_normal(key_, draw) : std::array<double, 2>{};
  }

 private:
  const OwnSurroundings& surroundings_;
  std::span<const base::Report> states_;
  std::uint32_t mover_;
  base::RandomKey key_;
  bool noise_;
};

/// "sensor 'nose' (compass)", for messages.
std::string own_sensor_name(const SensorSpec& spec, const OwnType& type) {
  return base::one_line(fmt::format("sensor '{}' ({})", spec.name, type.entry.name));
}

OwnSensor made_sensor(const world::World& world, const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number,
                      const OwnType& type) {
  OwnSensor own{common_spec(sensor, mover, number), nullptr};
  own.spec.rate = rate_of(sensor, type.entry.rate);
  own.spec.sigma = HUGE_VAL;  // the sensor may add noise
  const base::PluginCall under_way(own_sensor_name(own.spec, type));
  try {
    own.sensor = type.entry.make(
        {own.spec.name, world::CopyIndex(world).row_of(mover), number, public_pose(own.spec.X_MS), sensor.height},
        PublicSensorSettings(sensor));
  } catch (const base::InputError&) {
    throw;  // an invalid setting
  } catch (const std::exception& error) {
    refuse(sensor, "", base::one_line(error.what()));
  }
  if (own.sensor == nullptr) refuse(sensor, "", fmt::format("sensor type '{}' returned none", type.entry.name));
  own.spec.elements = std::clamp(own.sensor->elements(), 1u, 1u << 20);
  return own;
}

class OwnSensors final : public SensorBackend {
 public:
  OwnSensors(const SensorContext& context, const OwnType& type)
      : context_(context), type_(type), sensors_(own_sensors(context.world, type)), surroundings_(context) {
    std::size_t most = 1;
    for (const OwnSensor& each : sensors_) {
      most = std::max<std::size_t>(most, each.spec.elements);
      names_.push_back(own_sensor_name(each.spec, type));
    }
    stride_ = most * type.columns.size();
    if (!type.spirv.empty() && context.device.is_host())
      throw base::DeviceError(
          fmt::format("{} has its own kernel ({}), which requires a Vulkan device; install a driver (Debian: "
                      "mesa-vulkan-drivers), or leave out --device host",
                      names_.front(), type.entry.kernel));
    if (!type.spirv.empty() && context.world.copies > 1)
      throw base::InputError(
          fmt::format("{} has its own kernel ({}), which sees the robots of all worlds; expected a "
                      "sensor without a kernel, or one world",
                      names_.front(), type.entry.kernel));
    if (!type.spirv.empty()) kernel_ = std::make_unique<OwnKernel>(context, type, sensors_.size(), most);
    values_.resize(sensors_.size() * stride_);
  }

  void accumulate(std::int64_t now, bool) override { now_ = now; }
  void place_movers() override {
    surroundings_.place_movers();
    if (kernel_) kernel_->place_movers();
  }
  bool prepare(std::span<const DueSample> due) override;
  void record_measure(gpu::Batch& batch) override {
    if (kernel_) kernel_->record(batch);
  }
  void add_copies(gpu::Batch& batch) override {
    if (kernel_) kernel_->add_copies(batch);
  }
  void collect(std::span<base::ReadingBlock> out) override;
  /// Users' sensors may have a state.
  void take_over(SensorBackend& before, std::uint32_t rows) override {
    for (std::uint32_t i = 0; i < rows; ++i)
      sensors_[i].sensor.swap(dynamic_cast<OwnSensors&>(before).sensors_[i].sensor);
  }
  /// A sensor may have a state, so another object takes its place.
  void restart(std::uint32_t row, std::int64_t /*now*/) override {
    const SensorSpec& spec = sensors_[row].spec;
    std::uint32_t number = 0;
    for (const world::Sensor& sensor : context_.world.movers[spec.mover].sensors)
      if (sensor.type == type_.entry.name && number++ == spec.sensor)
        sensors_[row] = made_sensor(context_.world, sensor, spec.mover, spec.sensor, type_);
  }
  SensorStats stats() const override { return {}; }
  bool on_device() const override { return kernel_ != nullptr; }

 private:
  void measure(std::size_t i);

  SensorContext context_;
  const OwnType& type_;
  std::vector<OwnSensor> sensors_;
  std::vector<std::string> names_;  ///< of `sensors_`
  OwnSurroundings surroundings_;
  std::unique_ptr<OwnKernel> kernel_;  ///< null: sensors are measured on the host only
  std::size_t stride_;                 ///< values of the longest reading
  std::vector<double> values_;         ///< per due sensor
  std::vector<DueSample> due_;
  std::vector<Pose> X_WS_;  ///< per due sensor
  std::int64_t now_ = 0;    ///< [ns]
  bool recorded_ = false;
  std::mutex failure_lock_;
  std::string failure_;  ///< failure of a measurement
};

bool OwnSensors::prepare(std::span<const DueSample> due) {
  due_.assign(due.begin(), due.end());
  X_WS_.clear();
  for (const DueSample& d : due_) {
    const SensorSpec& spec = sensors_[d.row].spec;
    const Pose& X_WS = X_WS_.emplace_back(base::compose(context_.states[spec.mover].X_WM, spec.X_MS));
    if (kernel_) kernel_->add(X_WS_.size() - 1, spec, X_WS, sensors_[d.row].sensor->parameters(), d.sequence);
  }
  if (kernel_) kernel_->close(due_.size());
  return !std::exchange(recorded_, true);
}

void OwnSensors::measure(std::size_t i) {
  const DueSample& due = due_[i];
  const OwnSensor& own = sensors_[due.row];
  const auto values = std::span(values_).subspan(i * stride_, own.spec.elements * type_.columns.size());
  if (kernel_)
    std::copy_n(kernel_->values(i).begin(), values.size(), values.begin());
  else
    std::fill(values.begin(), values.end(), 0.0);
  const base::RandomKey key =
      context_.episodes.key(base::RandomStream::own_sensors, own.spec.mover,
                            own.spec.sensor | std::uint32_t{type_.entry.id} << 24, due.sequence);
  const SensorSurroundings around(surroundings_, own.spec.mover, key, context_.noise);
  const double now = 1e-9 * static_cast<double>(now_ - context_.episodes.start_of(own.spec.mover));
  const base::PluginCall under_way(names_[due.row], now);
  const auto fail = [&](const char* why) {
    const std::scoped_lock guard(failure_lock_);
    failure_ = fmt::format("{} failed at {:.3f} s: {}", names_[due.row], now, base::one_line(why));
  };
  try {
    own.sensor->read({now, public_pose(X_WS_[i]), around}, values);
  } catch (const std::exception& error) {
    fail(error.what());
  } catch (...) {
    fail("it threw something that is not a std::exception");
  }
}

void OwnSensors::collect(std::span<base::ReadingBlock> out) {
  context_.thread_pool.parallel_for_each(due_.size(), 16, [this](std::size_t i, unsigned) { measure(i); });
  if (!failure_.empty()) throw base::InputError(failure_);
  for (std::size_t i = 0; i < due_.size(); ++i) {
    const SensorSpec& spec = sensors_[due_[i].row].spec;
    out[i] = {.mover = spec.mover,
              .sensor = spec.sensor,
              .type = type_.entry.id,
              .X_WS = X_WS_[i],
              .values = std::span<const double>(values_).subspan(i * stride_, spec.elements * type_.columns.size())};
  }
}

}  // namespace

std::vector<OwnSensor> own_sensors(const world::World& world, const OwnType& type) {
  std::vector<OwnSensor> found;
  for_each_of(world, type.entry.name, [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number) {
    found.push_back(made_sensor(world, sensor, mover, number, type));
  });
  return found;
}

std::unique_ptr<SensorBackend> make_own_backend(const SensorContext& context, const OwnType& type) {
  return std::make_unique<OwnSensors>(context, type);
}

}  // namespace sf::sensors
