#include "sensors/host_instruments.h"

#include <utility>

#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kPiece = 64;  // readings that a worker takes at once

}  // namespace

HostInstruments::HostInstruments(const SensorContext& context, const SensorKind& kind, std::vector<SensorRow> rows)
    : world_(context.world),
      thread_pool_(context.thread_pool),
      seed_(context.seed),
      kind_(kind.id),
      rows_(std::move(rows)) {
  first_.push_back(0);
  for (const SensorRow& row : rows_) first_.push_back(first_.back() + std::size_t{row.elements} * element_width(kind));
  values_.resize(first_.back());
  sights_.reserve(rows_.size());
}

bool HostInstruments::prepare(std::span<const DueSample> due, std::span<const Pose> poses) {
  sights_.clear();
  for (const DueSample& d : due) {
    const SensorRow& row = rows_[d.row];
    Pose X_WS = base::compose(poses[row.mover], row.X_MS);
    X_WS.z = world_.movers[row.mover].X_WM.z + row.X_MS.z;
    const auto values = std::span(values_).subspan(first_[d.row], first_[d.row + 1] - first_[d.row]);
    sights_.push_back({d.row, d.sequence, X_WS, values});
  }
  // A world of such kinds alone needs its empty batch recorded once.
  return !std::exchange(recorded_, true);
}

void HostInstruments::collect(std::vector<base::ReadingBlock>& out) {
  thread_pool_.parallel_for(sights_.size(), kPiece, [this](std::size_t first, std::size_t last, unsigned) {
    measure(std::span<const Sight>(sights_).subspan(first, last - first));
  });
  for (const Sight& sight : sights_) {
    const SensorRow& row = rows_[sight.row];
    out.push_back(
        {.mover = row.mover, .sensor = row.sensor, .kind = kind_, .X_WS = sight.X_WS, .values = sight.values});
  }
}

void for_each_sensor(const world::World& world, const SensorKind& kind, const std::function<void(Fitted)>& body) {
  for_each_of(world, kind.word.type, [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number) {
    body({sensor, common_row(sensor, mover, number)});
  });
}

}  // namespace sf::sensors
