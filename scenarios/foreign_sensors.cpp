#include "scenarios/foreign_sensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/error.h"
#include "base/suggest.h"
#include "sensors/gps.h"
#include "sensors/imu.h"
#include "sensors/own_sensors.h"
#include "world/stage/build_world.h"

namespace sf::scenarios {

namespace {

using Columns = std::vector<std::pair<std::string, std::string>>;

/// Columns of a pose with its covariance, for types that are new.
constexpr std::string_view kPose[] = {"x_m",   "y_m",         "yaw_rad", "valid",       "xx_m2",
                                      "xy_m2", "x_yaw_m_rad", "yy_m2",   "y_yaw_m_rad", "yaw_yaw_rad2"};

/// A sensor that no farm measures.
class Recorded final : public sensorfarm::Sensor {
  void read(const sensorfarm::Measurement&, std::span<double>) const override {
    throw std::runtime_error("its readings are those of a recording");
  }
};

const sensors::SensorType* type_called(std::string_view word) {
  for (const sensors::SensorType* type : sensors::sensor_types())
    if (type->name == word || type->word.type == word) return type;
  return nullptr;
}

std::uint8_t free_id() {
  std::uint8_t id = sensors::kFirstOwnId;
  while (id < sensors::kLastOwnId && sensors::find_sensor_type(id) != nullptr) ++id;
  return id;
}

const sensors::SensorType* add_type(const std::string& file, const std::string& word, std::uint8_t id,
                                    const Columns& columns) {
  sensorfarm::SensorEntry entry;
  entry.name = word;
  entry.id = id;
  for (const auto& [name, source] : columns) entry.columns.push_back({name});
  entry.make = [](const sensorfarm::SensorSite&, const sensorfarm::SensorSettings&) {
    return std::make_unique<Recorded>();
  };
  sensors::add_own_sensor(std::move(entry), file);
  return type_called(word);
}

/// Returns the unit at the end of a column's name: "rad_s" of "rate_rad_s"; empty if it is none of these.
std::string_view unit_at_end(std::string_view name) {
  static constexpr std::string_view kUnits[] = {
      "_rad_s", "_deg_s", "_m_s2", "_m_s", "_km_h", "_mm_s", "_m_rad", "_rad2", "_m2", "_mm", "_cm", "_km",
      "_rad",   "_deg",   "_uT",   "_nT",  "_mT",   "_ms",   "_us",    "_ns",   "_m",  "_s",  "_T"};
  for (const std::string_view unit : kUnits)
    if (name.ends_with(unit)) return unit.substr(1);
  return {};
}

bool is_filled_in(const sensors::SensorType& type, std::string_view column) {
  return type.id == sensors::kGps && column == "satellites";
}

/// Returns the key without which readings lack a column; empty: none.
std::string_view key_of(const sensors::SensorType& type, std::string_view column) {
  if (type.id == sensors::kGps && (column == "altitude_m" || column == "vdop")) return "altitude";
  return type.id == sensors::kImu && column.starts_with("orientation_") ? "orientation" : "";
}

}  // namespace

ForeignSensor bind_sensor(const std::string& file, const ForeignInput& input, const std::string& source,
                          const std::vector<std::string>& available) {
  ForeignSensor sensor{input, source, type_called(input.sensor.word)};
  const auto fail = [&](const std::string& why) { throw base::InputError(file, input.sensor.line, why); };
  const auto index_of = [&](std::string_view name) {
    return static_cast<std::size_t>(std::ranges::find(available, name) - available.begin());
  };
  Columns columns = input.columns;
  if (sensor.type == nullptr) {
    if (columns.empty())
      for (const std::string_view name : kPose)
        if (index_of(name) < available.size()) columns.emplace_back(name, name);
    if (columns.empty())
      fail(fmt::format("expected columns = [...] of the new sensor type '{}'; {} has {}", input.sensor.word, source,
                       fmt::join(available, ", ")));
    sensor.type = add_type(file, input.sensor.word, free_id(), columns);
  }
  if (sensor.type->derived != nullptr)
    fail(fmt::format("'{}' is a derived sensor type, which has no recorded readings", input.sensor.word));
  for (const auto& [name, from] : columns)
    if (std::ranges::find(sensor.type->columns, name, &sensors::Column::name) == sensor.type->columns.end())
      fail(fmt::format("sensor type '{}' has no column '{}'", sensor.type->name, name));
  for (const sensors::Column& column : sensor.type->columns) {
    const auto stated = std::ranges::find(columns, column.name, &std::pair<std::string, std::string>::first);
    const std::string_view key = key_of(*sensor.type, column.name);
    if (!key.empty() && input.sensor.value(key).empty()) {
      if (stated != columns.end())
        fail(fmt::format("column '{}' of {} needs {} = 1", column.name, sensor.type->name, key));
      continue;
    }
    const std::string from = stated == columns.end() ? std::string(column.name) : stated->second;
    sensor.from.push_back(index_of(from));
    if (sensor.from.back() < available.size() && column.width == 1) {
      const std::string_view ours = unit_at_end(column.name), theirs = unit_at_end(from);
      if (!theirs.empty() && !ours.empty() && ours != theirs)
        fail(fmt::format("'{}' of {} is in {}, but '{}' of {} needs {}: convert it first", from, source, theirs,
                         column.name, sensor.type->name, ours));
    } else if (stated == columns.end() && is_filled_in(*sensor.type, column.name)) {
      sensor.from.back() = kNotMeasured;
    } else {
      fail(fmt::format("{} has no column '{}' for '{}' of {}; it has {}", source, from, column.name, sensor.type->name,
                       fmt::join(available, ", ")));
    }
  }
  return sensor;
}

void add_foreign_types(const record::RunInfo& info) {
  for (const record::SensorTypeInfo& type : info.sensor_types) {
    const bool is_own = type.id >= sensors::kFirstOwnId && type.id <= sensors::kLastOwnId;
    if (!is_own || sensors::find_sensor_type(type.id) != nullptr || type_called(type.name) != nullptr) continue;
    Columns columns;
    for (const record::ColumnInfo& column : type.columns) columns.emplace_back(column.name, column.name);
    add_type(info.world, type.name, type.id, columns);
  }
}

world::World foreign_world(const DeriveFile& file, std::span<ForeignSensor> sensors) {
  std::string text = "name \"recorded\"\n";
  std::set<std::string> robots;
  for (const ForeignSensor& sensor : sensors)
    if (robots.insert(sensor.input.sensor.robot).second)
      text += fmt::format("position( name \"{}\" pose [{} 0 0 0] drive \"diff\" )\n", sensor.input.sensor.robot,
                          3 * robots.size());
  world::World world = world::build_world(file.file, text, {.sensors = sensors::world_file_words()});
  std::vector<SensorText> texts;
  std::map<std::pair<std::string, std::string>, std::uint32_t> before;  // by robot and type
  for (ForeignSensor& sensor : sensors) {
    SensorText& text_of = texts.emplace_back(sensor.input.sensor);
    text_of.word = sensor.type->word.type;
    sensor.number = before[{text_of.robot, text_of.word}]++;
    if (text_of.name().empty())
      text_of.properties.emplace_back("name", fmt::format("\"{}:{}\"", text_of.word, sensor.number));
  }
  const std::vector<std::uint32_t> rows = add_sensors(file.file, texts, world);
  std::vector<std::size_t> mounted(world.movers.size(), 0);
  for (std::size_t k = 0; k < sensors.size(); ++k) {
    sensors[k].mover = rows[k];
    world.movers[rows[k]].sensors[mounted[rows[k]]++].X_MS.yaw += sensors[k].yaw;
  }
  return world;
}

}  // namespace sf::scenarios
