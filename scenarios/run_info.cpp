#include "scenarios/run_info.h"

#include <filesystem>

#include "sensors/accuracy.h"
namespace sf::scenarios {

namespace {

record::SensorTypeInfo kind_info(const sensors::SensorType& kind) {
  record::SensorTypeInfo info{kind.id, std::string(kind.name), std::string(kind.list), {}, kind.is_scan};
  for (const sensors::Column& column : kind.columns)
    info.columns.push_back({std::string(column.name), column.width, column.whole});
  return info;
}

void add_kinds(const sensors::SensorSet& sensor_set, record::RunInfo& info) {
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    info.sensor_types.push_back(kind_info(*group.kind));
    for (const sensors::SensorSpec& row : group.rows)
      info.movers[row.mover].sensors.push_back(
          {group.kind->id, row.name, "", row.X_MS, row.rate, row.fov, row.elements, row.range_min, row.limit});
  }
}

}  // namespace

record::RunInfo run_info(const world::World& world, const sensors::SensorSet& sensor_set, const RunSettings& settings) {
  record::RunInfo info;
  info.world = world.name.empty() ? std::filesystem::path(world.file).filename().string() : world.name;
  info.world_hash = world.hash;
  info.seed = settings.seed;
  info.mode = sensors::modes_of(sensor_set);
  info.interval = world.interval;
  info.record_readings = settings.record_readings;
  info.options = {{"no_return", settings.no_return_inf ? "inf" : "max"}, {"caster", settings.caster}};
  info.snapshot = world::snapshot(world);
  for (const world::Mover& mover : world.movers) info.movers.push_back({mover.name, "", mover.id, {}});
  add_kinds(sensor_set, info);
  return info;
}

}  // namespace sf::scenarios
