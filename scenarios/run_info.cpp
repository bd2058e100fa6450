#include "scenarios/run_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "scenarios/standard_topics.h"
#include "scenarios/world_shape.h"
#include "sensors/accuracy.h"
#include "sensors/laser_modes.h"

namespace sf::scenarios {

namespace {

/// Messages of one row have no columns that are left out: `rows` of such a type have the same ones.
record::SensorTypeInfo sensor_type_info(const sensors::SensorType& type, std::span<const sensors::SensorSpec> rows) {
  record::SensorTypeInfo info{type.id, std::string(type.name), std::string(type.list), {}, type.is_scan};
  const std::size_t width = type.list.empty() ? sensors::element_width(type, rows[0]) : sensors::element_width(type);
  std::size_t before = 0;
  for (const sensors::Column& column : type.columns) {
    if (before >= width) break;
    info.columns.push_back({std::string(column.name), column.width, column.whole});
    before += column.width;
  }
  return info;
}

void add_type(const sensors::SensorSet& sensor_set, record::RunInfo& info) {
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    info.sensor_types.push_back(sensor_type_info(*group.type, group.rows));
    for (std::size_t i = 0; i < group.rows.size(); ++i) {
      const sensors::SensorSpec& row = group.rows[i];
      auto& mounted = info.movers[row.mover].sensors;
      mounted.push_back({group.type->id, row.name, "", row.X_MS, row.rate, row.fov, row.elements, row.range_min,
                         row.limit, row.width, row.sweep});
      if (group.type->is_scan) mounted.back().tilt = group.settings_as<sensors::CastLaser>()[i].laser.tilt;
    }
  }
}

/// JSON has no infinite numbers.
std::string number_or_null(double value) { return std::isfinite(value) ? fmt::format("{}", value) : "null"; }

/// Returns the bounds of the recorded numbers: scans have 32 bits. Flags are not recorded.
std::vector<std::string> accuracy_rows(const world::World& world, const sensors::SensorSet& sensor_set, bool noise) {
  std::vector<std::string> rows;
  for (const sensors::AccuracyStatement& s : sensors::accuracy_statements(world, sensor_set)) {
    const double sigma = noise ? s.sigma : 0.0, without_noise = s.bound.error;
    double rounding = 0.0;
    if (s.type->is_scan)
      for (const sensors::SensorSpec& row : sensor_set.group(s.type->id)->rows)
        rounding = std::max(rounding, recorded_rounding(row.limit));
    rows.push_back(fmt::format(
        R"({{"type":"{}","sensors":{},"mode":"{}","bound":{},"bound_without_noise":{},"sigma":{},"unit":"{}",)"
        R"("condition":"{}","flags":"not recorded"}})",
        s.type->name, s.sensors, sensors::word_of(*s.type, s.mode),
        number_or_null(sigma > 0.0 ? HUGE_VAL : without_noise + rounding), number_or_null(without_noise + rounding),
        number_or_null(sigma), sensors::unit_of(*s.type), s.bound.condition));
  }
  return rows;
}

/// Selects the only robot as the one without a namespace. Tags, objects and robots that join keep their own.
void choose_plain(const world::World& world, record::RunInfo& info) {
  std::vector<std::size_t> robots;
  for (std::size_t row = 0; row + info.joined.size() < world.movers.size(); ++row)
    if (!world.movers[row].is_tag) robots.push_back(row);
  if (robots.size() != 1)
    throw base::InputError(world.file, 0,
                           fmt::format("has {} robots, but plain topic names are for a single robot: expected --topics "
                                       "robot or nav2, or a world with one robot",
                                       robots.size()));
  info.movers[robots[0]].plain = true;
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
  if (settings.record_readings) info.odometry_rate = 1.0 / world.interval;  // every tick, as for viewers
  info.estimated = settings.estimated;
  info.options = {{std::string(record::kNoReturn), settings.no_return_inf ? "inf" : "max"},
                  {"caster", settings.caster}};
  info.accuracy = accuracy_rows(world, sensor_set, settings.noise);
  if (settings.too_near_min) info.options.emplace_back(record::kTooNear, "min");
  if (!settings.faults.empty()) info.options.emplace_back(record::kFaultsOption, settings.faults);
  record::put_naming(settings.naming, info);
  info.snapshot = world::snapshot(world);
  info.joined = settings.joined;
  for (const world::Mover& mover : world.movers) {
    info.movers.push_back({mover.name, "", mover.id, {}, body_of(world, mover)});
    info.movers.back().max_forward = mover.max_forward;
    info.movers.back().tag = mover.is_tag;
  }
  if (settings.naming.style == record::TopicStyle::plain) choose_plain(world, info);
  info.shape = shape_of(world);
  for (const world::Light& light : world.lights) info.lights.push_back(light.name);
  add_type(sensor_set, info);
  add_standard_topics(sensor_set, settings.images, info);
  return info;
}

}  // namespace sf::scenarios
