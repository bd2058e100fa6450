#include "scenarios/run_info.h"

#include <filesystem>

#include "scenarios/standard_topics.h"
#include "scenarios/world_shape.h"
#include "sensors/accuracy.h"

namespace sf::scenarios {

namespace {

record::SensorTypeInfo sensor_type_info(const sensors::SensorType& type) {
  record::SensorTypeInfo info{type.id, std::string(type.name), std::string(type.list), {}, type.is_scan};
  for (const sensors::Column& column : type.columns)
    info.columns.push_back({std::string(column.name), column.width, column.whole});
  return info;
}

void add_type(const sensors::SensorSet& sensor_set, record::RunInfo& info) {
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    info.sensor_types.push_back(sensor_type_info(*group.type));
    for (const sensors::SensorSpec& row : group.rows)
      info.movers[row.mover].sensors.push_back(
          {group.type->id, row.name, "", row.X_MS, row.rate, row.fov, row.elements, row.range_min, row.limit});
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
  if (settings.record_readings) info.odometry_rate = 1.0 / world.interval;  // every tick, as viewers draw them
  info.estimated = settings.estimated;
  info.options = {{"no_return", settings.no_return_inf ? "inf" : "max"}, {"caster", settings.caster}};
  info.snapshot = world::snapshot(world);
  for (const world::Mover& mover : world.movers)
    info.movers.push_back({mover.name, "", mover.id, {}, body_of(world, mover)});
  info.shape = shape_of(world);
  for (const world::Light& light : world.lights) info.lights.push_back(light.name);
  add_type(sensor_set, info);
  add_standard_topics(world, info);
  return info;
}

}  // namespace sf::scenarios
