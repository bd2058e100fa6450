#include "record/run_info.h"

#include <algorithm>
#include <cctype>
#include <map>

#include "base/error.h"
#include "record/cdr.h"

namespace sf::record {

namespace {

/// ROS names: letters, digits, '_'; no digit first.
std::string ros_name(const std::string& name, const std::string& otherwise) {
  std::string text;
  for (const char c : name) text += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  if (text.empty()) return otherwise;
  return std::isdigit(static_cast<unsigned char>(text[0])) != 0 ? "_" + text : text;
}

/// Names in use, each with the next number for a duplicate.
using Taken = std::map<std::string, int>;

std::string unique(const std::string& name, Taken& taken) {
  const auto [known, is_new] = taken.try_emplace(name, 2);
  if (is_new) return name;
  std::string candidate;
  do {
    candidate = name + "_" + std::to_string(known->second++);
  } while (!taken.try_emplace(candidate, 2).second);
  return candidate;
}

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

const char* name_of(StandardTopic::Message message) {
  switch (message) {
    case StandardTopic::Message::range:
      return "range";
    case StandardTopic::Message::magnetic_field:
      return "field";
    case StandardTopic::Message::fix:
      return "fix";
    case StandardTopic::Message::imu:
      return "imu";
    case StandardTopic::Message::map:
      return "map";
  }
  return "";
}

/// "/robot/sonar/range_3" and the frame "robot/sonar/range_3"; of a sensor of one element "/robot/gps/fix" in the frame
/// "robot/gps".
void name_standard_topics(SensorInfo& sensor) {
  const std::string frame = frame_of(sensor);
  for (StandardTopic& each : sensor.standard) {
    const std::string name = name_of(each.message);
    const bool single = sensor.standard.size() == 1;
    each.frame = single ? frame : frame + "/" + name + "_" + std::to_string(each.element);
    each.topic = "/" + (single ? frame + "/" + name : each.frame);
  }
}

const SensorTypeInfo& type_of(const RunInfo& info, const SensorInfo& sensor) {
  const SensorTypeInfo* type = find_sensor_type(info, sensor.type);
  SF_CHECK(type != nullptr, "sensor type " + std::to_string(sensor.type));
  return *type;
}

void put_mover(CdrWriter& cdr, const RunInfo& info, const MoverInfo& mover) {
  cdr.put(std::string_view(mover.name));
  cdr.put(std::string_view(mover.frame));
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
  mover.frame = cdr.get_string();
  mover.id = cdr.get<std::uint32_t>();
  for (const bool scans : {true, false})
    for (std::size_t left = cdr.get_count(scans ? kLeastLaser : kLeastSensor); left > 0; --left)
      mover.sensors.push_back(get_sensor(cdr, scans));
  return mover;
}

}  // namespace

std::string frame_of(const SensorInfo& sensor) { return sensor.topic.substr(1, sensor.topic.rfind('/') - 1); }

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

void name_frames(RunInfo& info) {
  Taken frames = {{"world", 2}, {"run", 2}, {"fleet", 2}, {"clock", 2}, {"map", 2}, {"walls", 2}, {"bodies", 2}};
  for (MoverInfo& mover : info.movers) {
    mover.frame = unique(ros_name(mover.name, "robot"), frames);
    Taken sensors = {{"odom", 2}, {"cmd_vel", 2}};
    for (SensorInfo& sensor : mover.sensors) {
      const SensorTypeInfo& type = type_of(info, sensor);
      sensor.topic = "/" + mover.frame + "/" + unique(ros_name(sensor.name, type.name), sensors) + "/" +
                     (type.is_scan ? "scan" : type.name);
      name_standard_topics(sensor);
    }
  }
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
