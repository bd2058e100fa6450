#include "sensors/host_backend.h"

#include <utility>

#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kPiece = 64;  // readings per piece of work

}  // namespace

HostBackend::HostBackend(const SensorContext& context, const SensorType& type, const ParsedSensors& sensors)
    : world_(context.world),
      thread_pool_(context.thread_pool),
      states_(context.states),
      episodes_(context.episodes),
      type_(type.id),
      rows_(sensors.rows) {
  first_.push_back(0);
  for (const SensorSpec& row : rows_) first_.push_back(first_.back() + row.elements * element_width(type, row));
  values_.resize(first_.back());
  samples_.reserve(rows_.size());
}

bool HostBackend::prepare(std::span<const DueSample> due) {
  samples_.clear();
  for (const DueSample& d : due) {
    const SensorSpec& row = rows_[d.row];
    const auto values = std::span(values_).subspan(first_[d.row], first_[d.row + 1] - first_[d.row]);
    samples_.push_back({d.row, d.sequence, base::compose(states_[row.mover].X_WM, row.X_MS), values});
  }
  // In a world without device work, the empty batch must be recorded once.
  return !std::exchange(recorded_, true);
}

void HostBackend::measure_all() {
  thread_pool_.parallel_for(samples_.size(), kPiece, [this](std::size_t first, std::size_t last, unsigned) {
    measure(std::span<const HostSample>(samples_).subspan(first, last - first));
  });
}

void HostBackend::collect(std::span<base::ReadingBlock> out) {
  measure_all();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const HostSample& sample = samples_[i];
    const SensorSpec& row = rows_[sample.row];
    out[i] = {.mover = row.mover, .sensor = row.sensor, .type = type_, .X_WS = sample.X_WS, .values = sample.values};
  }
}

void for_each_sensor(const world::World& world, const SensorType& type,
                     const std::function<void(MountedSensor)>& body) {
  for_each_of(world, type.word.type, [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number) {
    body({sensor, common_spec(sensor, mover, number)});
  });
}

}  // namespace sf::sensors
