#include "farm/reading_order.h"

#include "base/error.h"
#include "base/time.h"

namespace sf::farm {

namespace {

/// Late readings come first, by mover, type and sensor (farm/delivery.cpp).
std::uint64_t late_rank(const sensors::SensorSpec& row, std::uint8_t type) {
  return std::uint64_t{row.mover} << 31 | std::uint64_t{type} << 23 | row.sensor;
}

/// The other readings follow type by type: those that are computed from another type's after these, and derived
/// sensors last.
std::uint64_t prompt_rank(const sensors::SensorType& type, std::size_t row) {
  const std::uint64_t last = type.derived != nullptr, later = type.derived_from != 0;
  return std::uint64_t{1} << 63 | last << 62 | later << 61 | std::uint64_t{type.id} << 32 | row;
}

}  // namespace

ReadingOrder::ReadingOrder(const sensors::SensorSet& sensor_set) {
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    const std::uint8_t id = group.type->id;
    if (types_.size() <= id) types_.resize(id + std::size_t{1});
    types_[id] = {sensors(), group.first};
    for (std::size_t row = 0; row < group.rows.size(); ++row) {
      const std::int64_t latency = base::nanoseconds(group.rows[row].latency);
      SF_CHECK(group.rows[row].sensor < 1u << 23, std::to_string(group.rows[row].sensor) + " sensors of one type");
      sensors_.push_back({latency, latency > 0 ? late_rank(group.rows[row], id) : prompt_rank(*group.type, row)});
    }
  }
}

std::uint32_t ReadingOrder::sensor_of(std::uint8_t type, std::uint32_t mover, std::uint32_t sensor) const {
  return types_.at(type).before + types_[type].first.at(mover) + sensor;
}

}  // namespace sf::farm
