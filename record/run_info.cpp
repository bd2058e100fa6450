#include "record/run_info.h"

#include <algorithm>

#include "base/error.h"
#include "record/cdr.h"

namespace sf::record {

namespace {

void put_plain_pose(CdrWriter& cdr, const base::Pose& pose) {
  for (const double value : {pose.x, pose.y, pose.z, pose.yaw}) cdr.put(value);
}

void get_plain_pose(CdrReader& cdr, base::Pose& pose) {
  for (double* value : {&pose.x, &pose.y, &pose.z, &pose.yaw}) *value = cdr.get<double>();
}

const SensorTypeInfo kScans{1, "laser", "beams", {{"range_m"}}, true};

void put_sensor_type(CdrWriter& cdr, const SensorTypeInfo& type) {
  cdr.put(type.id);
  cdr.put(std::string_view(type.name));
  cdr.put(std::string_view(type.list));
  cdr.put_count(type.columns.size());
  for (const ColumnInfo& column : type.columns) {
    cdr.put(std::string_view(column.name));
    cdr.put(column.width);
    cdr.put(column.whole);
  }
}

SensorTypeInfo get_sensor_type(CdrReader& cdr) {
  constexpr std::size_t kLeastColumn = 10;  // [byte]
  SensorTypeInfo type;
  type.id = cdr.get<std::uint8_t>();
  type.name = cdr.get_string();
  type.list = cdr.get_string();
  type.columns.resize(cdr.get_count(kLeastColumn));
  for (ColumnInfo& column : type.columns) {
    column.name = cdr.get_string();
    column.width = cdr.get<std::uint32_t>();
    column.whole = cdr.get<bool>();
  }
  return type;
}

void put_sensor(CdrWriter& cdr, const SensorInfo& sensor, bool is_scan) {
  if (!is_scan) cdr.put(sensor.type);
  cdr.put(std::string_view(sensor.name));
  cdr.put(std::string_view(sensor.topic));
  put_plain_pose(cdr, sensor.X_MS);
  if (is_scan) {
    cdr.put(sensor.fov);
    cdr.put(sensor.samples);
    cdr.put(sensor.range_min);
    cdr.put(sensor.range_max);
  }
  cdr.put(sensor.rate);
}

SensorInfo get_sensor(CdrReader& cdr, bool is_scan) {
  SensorInfo sensor;
  sensor.type = is_scan ? kScans.id : cdr.get<std::uint8_t>();
  sensor.name = cdr.get_string();
  sensor.topic = cdr.get_string();
  get_plain_pose(cdr, sensor.X_MS);
  if (is_scan) {
    sensor.fov = cdr.get<double>();
    sensor.samples = cdr.get<std::uint32_t>();
    sensor.range_min = cdr.get<double>();
    sensor.range_max = cdr.get<double>();
  }
  sensor.rate = cdr.get<double>();
  return sensor;
}

const SensorTypeInfo& type_of(const RunInfo& info, const SensorInfo& sensor) {
  const SensorTypeInfo* type = find_sensor_type(info, sensor.type);
  SF_CHECK(type != nullptr, "sensor type " + std::to_string(sensor.type));
  return *type;
}

void put_mover(CdrWriter& cdr, const RunInfo& info, const MoverInfo& mover) {
  cdr.put(std::string_view(mover.name));
  cdr.put(std::string_view(mover.base_frame));
  cdr.put(mover.id);
  for (const bool scans : {true, false}) {
    const auto listed = [&](const SensorInfo& sensor) { return type_of(info, sensor).is_scan == scans; };
    cdr.put_count(static_cast<std::size_t>(std::count_if(mover.sensors.begin(), mover.sensors.end(), listed)));
    for (const SensorInfo& sensor : mover.sensors)
      if (listed(sensor)) put_sensor(cdr, sensor, scans);
  }
}

MoverInfo get_mover(CdrReader& cdr) {
  constexpr std::size_t kLeastLaser = 80, kLeastSensor = 50;  // [byte]
  MoverInfo mover;
  mover.name = cdr.get_string();
  mover.base_frame = cdr.get_string();
  mover.id = cdr.get<std::uint32_t>();
  for (const bool scans : {true, false})
    for (std::size_t left = cdr.get_count(scans ? kLeastLaser : kLeastSensor); left > 0; --left)
      mover.sensors.push_back(get_sensor(cdr, scans));
  return mover;
}

}  // namespace

std::string_view option_of(const RunInfo& info, std::string_view key) {
  const auto found =
      std::find_if(info.options.begin(), info.options.end(), [&](const auto& o) { return o.first == key; });
  return found == info.options.end() ? std::string_view() : found->second;
}

const SensorTypeInfo* find_sensor_type(const RunInfo& info, std::uint8_t id) {
  for (const SensorTypeInfo& type : info.sensor_types)
    if (type.id == id) return &type;
  return nullptr;
}

void encode_run_info(const RunInfo& info, base::Bytes& out) {
  CdrWriter cdr(out);
  cdr.put(std::string_view(info.world));
  cdr.put(info.world_hash);
  cdr.put(info.seed);
  cdr.put(std::string_view(info.mode));
  cdr.put(info.interval);
  cdr.put(info.record_readings);
  cdr.put(info.odometry_rate);
  const auto& types = info.sensor_types;
  const auto is_scan = [](const SensorTypeInfo& type) { return type.is_scan; };
  cdr.put_count(types.size() - static_cast<std::size_t>(std::count_if(types.begin(), types.end(), is_scan)));
  for (const SensorTypeInfo& type : types)
    if (!type.is_scan) put_sensor_type(cdr, type);
  cdr.put_count(info.movers.size());
  for (const MoverInfo& mover : info.movers) put_mover(cdr, info, mover);
  cdr.put_count(info.options.size());
  for (const auto& [key, value] : info.options) {
    cdr.put(std::string_view(key));
    cdr.put(std::string_view(value));
  }
}

bool decode_run_info(std::span<const std::uint8_t> message, RunInfo& info) {
  constexpr std::size_t kLeastKind = 18, kLeastMover = 20, kLeastOption = 10;  // [byte]
  CdrReader cdr(message);
  info.world = cdr.get_string();
  info.world_hash = cdr.get<std::uint64_t>();
  info.seed = cdr.get<std::uint64_t>();
  info.mode = cdr.get_string();
  info.interval = cdr.get<double>();
  info.record_readings = cdr.get<bool>();
  info.odometry_rate = cdr.get<double>();
  info.sensor_types = {kScans};
  for (std::size_t left = cdr.get_count(kLeastKind); left > 0; --left) {
    info.sensor_types.push_back(get_sensor_type(cdr));
    if (info.sensor_types.back().id == kScans.id) return false;
  }
  info.movers.resize(cdr.get_count(kLeastMover));
  for (MoverInfo& mover : info.movers) mover = get_mover(cdr);
  info.options.resize(cdr.get_count(kLeastOption));
  for (auto& [key, value] : info.options) {
    key = cdr.get_string();
    value = cdr.get_string();
    info.estimated = info.estimated || (key == "states" && value == "estimated");
  }
  return cdr.good();
}

}  // namespace sf::record
