#include "sensors/sensor_set.h"

#include <algorithm>

#include "base/error.h"
#include "sensors/accuracy.h"
#include "sensors/derived/derived_sensors.h"

namespace sf::sensors {

SensorSet::SensorSet(const world::World& world) {
  for (const SensorType* type : sensor_types()) {
    Group group{type->parse(world), type, {}};
    if (group.rows.empty()) continue;
    std::uint32_t at = 0;
    for (std::uint32_t m = 0; m <= world.movers.size(); ++m) {
      while (at < group.rows.size() && group.rows[at].mover < m) ++at;
      group.first.push_back(at);
    }
    groups_.push_back(std::move(group));
  }
  std::vector<const SensorType*> present;
  for (const Group& group : groups_) present.push_back(group.type);
  check_accuracy(world, present);
  check_derived_sensors(world, *this);
}

const SensorSet::Group* SensorSet::group(std::uint8_t type) const {
  const auto found = std::find_if(groups_.begin(), groups_.end(), [&](const Group& g) { return g.type->id == type; });
  return found == groups_.end() ? nullptr : &*found;
}

std::span<const SensorSpec> SensorSet::of(std::uint8_t type, std::uint32_t mover) const {
  const Group* found = group(type);
  if (found == nullptr || mover + 1 >= found->first.size()) return {};
  return std::span(found->rows).subspan(found->first[mover], found->first[mover + 1] - found->first[mover]);
}

const SensorSpec& SensorSet::row(const base::ReadingBlock& reading) const {
  const auto rows = of(reading.type, reading.mover);
  SF_CHECK(reading.sensor < rows.size(), "type " + std::to_string(reading.type) + " of mover " +
                                             std::to_string(reading.mover) + " has no sensor " +
                                             std::to_string(reading.sensor));
  return rows[reading.sensor];
}

SpatialBeams SensorSet::beams(const base::ReadingBlock& reading) const {
  const Group& found = *group(reading.type);
  return found.type->beams(found, found.first[reading.mover] + reading.sensor);
}

std::size_t SensorSet::count() const {
  std::size_t sum = 0;
  for (const Group& group : groups_) sum += group.rows.size();
  return sum;
}

std::size_t SensorSet::count_of(std::uint32_t mover) const {
  std::size_t sum = 0;
  for (const Group& group : groups_) sum += of(group.type->id, mover).size();
  return sum;
}

double own_noise(const SensorSet::Group& group, const SensorSpec& row, std::uint32_t offset) {
  if (group.type->noise != nullptr)
    return group.type->noise(group, static_cast<std::size_t>(&row - group.rows.data()), offset);
  return offset == 0 ? row.sigma : HUGE_VAL;
}

}  // namespace sf::sensors
