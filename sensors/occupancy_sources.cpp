#include "sensors/occupancy_sources.h"

#include <algorithm>
#include <array>
#include <utility>

#include "sensors/infrared.h"
#include "sensors/laser.h"
#include "sensors/sonar.h"

namespace sf::sensors {

namespace {

RangeSensor range_sensor_of(const base::ReadingBlock* reading) {
  return {reading->type, reading->mover, reading->sensor};
}

}  // namespace

SourceMaps::SourceMaps(const world::World& world, std::span<const Occupancy> maps, base::ThreadPool& thread_pool)
    : thread_pool_(thread_pool), maps_(maps.size()), evidence_(thread_pool.threads()) {
  for (std::size_t i = 0; i < maps.size(); ++i) {
    if (maps[i].sources.empty()) continue;
    maps_[i] = std::make_unique<Map>(Map{{maps[i].settings.grid, *maps[i].settings.odds}, {}});
    for (const RangeSensor& sensor : maps[i].sources) maps_[i]->sources.emplace_back(world, sensor);
    any_ = true;
  }
}

void SourceMaps::add_readings(Map& map, maps::RangeEvidence& evidence) const {
  for (RangeSource& source : map.sources) {
    const auto found = std::ranges::lower_bound(readings_, source.sensor(), {}, range_sensor_of);
    if (found == readings_.end() || range_sensor_of(*found) != source.sensor()) continue;
    source.add_to(std::array{&map.grid}, source.cones(**found, (*found)->X_WM), evidence);
  }
}

void SourceMaps::observe(std::span<const base::ReadingBlock> readings) {
  if (!any_) return;
  readings_.clear();
  for (const base::ReadingBlock& reading : readings)
    if (reading.type == kLaser || reading.type == kSonar || reading.type == kInfrared) readings_.push_back(&reading);
  std::ranges::sort(readings_, {}, range_sensor_of);
  thread_pool_.parallel_for_each(maps_.size(), 1, [&](std::size_t i, unsigned thread) {
    if (maps_[i] != nullptr) add_readings(*maps_[i], evidence_[thread]);
  });
}

void SourceMaps::restart(const world::World& world, std::uint32_t map) {
  Map& own = *maps_[map];
  own.grid = {own.grid.geometry, own.grid.rule};
  for (RangeSource& source : own.sources) source = RangeSource(world, source.sensor());
}

void SourceMaps::take_over(SourceMaps& before, std::uint32_t rows) {
  for (std::uint32_t i = 0; i < rows; ++i) {
    if (maps_[i] == nullptr) continue;
    std::swap(maps_[i]->grid, before.maps_[i]->grid);
    for (RangeSource& source : maps_[i]->sources) {
      auto& known = before.maps_[i]->sources;
      const auto same = std::ranges::find(known, source.sensor(), &RangeSource::sensor);
      if (same != known.end()) std::swap(source, *same);
    }
  }
}

}  // namespace sf::sensors
