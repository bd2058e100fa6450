#include "server/published_tick.h"

#include <algorithm>

namespace sf::server {

PublishedTick::PublishedTick(const sensors::SensorSet& sensor_set) : sensor_set_(sensor_set) {
  std::size_t rows = 0;
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    first_.push_back(static_cast<std::uint32_t>(rows));
    rows += group.rows.size();
  }
  newest_.resize(rows);
}

void PublishedTick::take(const base::TickRecord& record) {
  tick_ = record.tick;
  time_ = record.time;
  reports_.assign(record.reports.begin(), record.reports.end());
  contacts_.assign(record.contacts.begin(), record.contacts.end());
  for (const base::ReadingBlock& reading : record.readings) {
    Newest& newest = newest_[row_of(reading)];
    newest.reading.take(reading);
    newest.tick = tick_;
  }
}

std::uint32_t PublishedTick::row_of(const base::ReadingBlock& reading) const {
  const auto groups = sensor_set_.groups();
  const auto at = std::find_if(groups.begin(), groups.end(),
                               [&](const sensors::SensorSet::Group& group) { return group.type->id == reading.type; });
  return first_[static_cast<std::size_t>(at - groups.begin())] + at->first[reading.mover] + reading.sensor;
}

void PublishedTick::find_new(std::uint32_t mover, base::SensorTypes types, std::optional<std::uint64_t> after,
                             std::vector<std::uint32_t>& rows) const {
  const auto groups = sensor_set_.groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    if ((types >> groups[g].type->id & 1u) == 0) continue;
    for (std::uint32_t i = groups[g].first[mover]; i < groups[g].first[mover + 1]; ++i) {
      const std::optional<std::uint64_t>& tick = newest_[first_[g] + i].tick;
      if (tick && (!after || *tick > *after)) rows.push_back(first_[g] + i);
    }
  }
}

}  // namespace sf::server
