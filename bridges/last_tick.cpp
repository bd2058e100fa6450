#include "bridges/last_tick.h"

namespace sf::bridges {

namespace {

template <class T>
std::span<const T> keep(std::vector<T>& own, std::span<const T> given) {
  own.assign(given.begin(), given.end());
  return own;
}

}  // namespace

void LastTick::store(const base::TickRecord& tick, bool with_readings) {
  if (!with_readings || tick.time < tick_.time) {
    readings_.clear();
    rows_.clear();
  }
  tick_.tick = tick.tick;
  tick_.time = tick.time;
  tick_.reports = keep(reports_, tick.reports);
  tick_.commands = keep(commands_, tick.commands);
  tick_.contacts = keep(contacts_, tick.contacts);
  tick_.qualities = keep(qualities_, tick.qualities);
  tick_.lights = keep(lights_, tick.lights);
  for (const base::ReadingBlock& reading : tick.readings)
    if (with_readings) store(reading);
}

void LastTick::store(const base::ReadingBlock& reading) {
  const std::uint64_t key = std::uint64_t{reading.mover} << 32 | std::uint64_t{reading.type} << 24 | reading.sensor;
  const auto [row, is_new] = rows_.try_emplace(key, readings_.size());
  if (is_new) readings_.emplace_back();
  Stored& stored = readings_[row->second];
  stored.block = reading;
  stored.block.values = keep(stored.values, reading.values);
  stored.block.hits = {};
  stored.block.quality = keep(stored.quality, reading.quality);
}

const base::TickRecord& LastTick::record() {
  blocks_.clear();
  for (const Stored& stored : readings_) {
    blocks_.push_back(stored.block);
    blocks_.back().values = stored.values;  // the table may have been reallocated
    blocks_.back().quality = stored.quality;
  }
  tick_.readings = blocks_;
  return tick_;
}

}  // namespace sf::bridges
