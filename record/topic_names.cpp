#include "record/topic_names.h"

#include <fmt/format.h>

#include <cctype>
#include <map>

#include "base/error.h"

namespace sf::record {

namespace {

constexpr std::string_view kStyleOption = "topics", kOdometryOption = "odometry", kExternalOption = "external";
constexpr std::size_t kLongestName = 64;  // DDS and ROS limit a topic to about 250 characters

bool is_name_character(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }
bool begins_with_digit(const std::string& name) { return std::isdigit(static_cast<unsigned char>(name[0])) != 0; }

/// ROS 2 hides topics with parts that begin with '_', and refuses repeated '_'.
std::string ros_name(const std::string& name, const std::string& otherwise) {
  std::string text;
  for (const char c : name.substr(0, kLongestName)) {
    if (is_name_character(c))
      text += c;
    else if (!text.empty() && text.back() != '_')
      text += '_';
  }
  if (!text.empty() && text.back() == '_') text.pop_back();
  if (text.empty()) return otherwise;
  return begins_with_digit(text) ? otherwise + "_" + text : text;
}

/// The same for TopicStyle::sensor.
std::string plain_ros_name(const std::string& name, const std::string& otherwise) {
  std::string text;
  for (const char c : name) text += is_name_character(c) ? c : '_';
  if (text.empty()) return otherwise;
  return begins_with_digit(text) ? "_" + text : text;
}

/// Names in use, each with the next number for a duplicate.
using Taken = std::map<std::string, int>;

Taken taken_names(std::initializer_list<const char*> names, int next) {
  Taken taken;
  for (const char* name : names) taken.emplace(name, next);
  return taken;
}

/// @param first number of the first duplicate
std::string unique(const std::string& name, Taken& taken, int first) {
  const auto [known, is_new] = taken.try_emplace(name, first);
  if (is_new) return name;
  std::string candidate;
  do {
    candidate = name + "_" + std::to_string(known->second++);
  } while (!taken.try_emplace(candidate, first).second);
  return candidate;
}

const char* word_of(StandardTopic::Message message) {
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
    case StandardTopic::Message::points:
      return "points";
    case StandardTopic::Message::radar_scan:
      return "scan";
    case StandardTopic::Message::depth_image:
      return "depth/image_raw";
    case StandardTopic::Message::color_image:
      return "image_raw";
    case StandardTopic::Message::depth_png:
      return "depth/image_raw/compressedDepth";
    case StandardTopic::Message::color_file:
      return "image_raw/compressed";
    case StandardTopic::Message::camera_info:
      return "camera_info";
  }
  return "";
}

/// Names the topic "PREFIX/range_3" and the frame "SENSOR/range_3"; for a sensor with one element "PREFIX/fix" and
/// "SENSOR". Maps have the frame `world`; the images of a camera have names as in image_pipeline, and one optical
/// frame.
void name_standard_topics(SensorInfo& sensor, const std::string& prefix) {
  const bool single = sensor.standard.size() == 1;
  for (StandardTopic& each : sensor.standard) {
    std::string name = word_of(each.message);
    const bool image = each.columns > 0;
    if (!single && !image) name += "_" + std::to_string(each.element);
    each.topic = prefix + "/" + name;
    each.frame = each.message == StandardTopic::Message::map ? "world"
                 : image                                     ? sensor.frame + "_optical_frame"
                 : single                                    ? sensor.frame
                                                             : sensor.frame + "/" + name;
  }
}

/// Returns the last word of a sensor's topic: "scan", "gps"; "imu_reading" where a standard message is called "imu".
std::string topic_word(const SensorTypeInfo& type, const SensorInfo& sensor) {
  if (type.is_scan) return "scan";
  for (const StandardTopic& each : sensor.standard)
    if (type.name == word_of(each.message)) return type.name + "_reading";
  return type.name;
}

const SensorTypeInfo& sensor_type_of(const RunInfo& info, const SensorInfo& sensor) {
  const SensorTypeInfo* type = find_sensor_type(info, sensor.type);
  SF_CHECK(type != nullptr, "sensor type " + std::to_string(sensor.type));
  return *type;
}

/// TopicStyle::sensor: names topics after the sensor's own name.
void name_by_sensors(const RunInfo& info, MoverInfo& mover) {
  mover.space = "/" + mover.frame;
  mover.base_frame = mover.frame;
  mover.odom_frame = "world";
  Taken sensors = taken_names({"odom", "cmd_vel"}, 2);
  for (SensorInfo& sensor : mover.sensors) {
    const SensorTypeInfo& type = sensor_type_of(info, sensor);
    sensor.frame = mover.frame + "/" + unique(plain_ros_name(sensor.name, type.name), sensors, 2);
    sensor.topic = "/" + sensor.frame + "/" + topic_word(type, sensor);
    name_standard_topics(sensor, "/" + sensor.frame);
  }
}

/// Names topics after the sensor's type: `scan`, `scan_1`, ... Imu messages use the robot's topic `imu`.
void name_by_types(const RunInfo& info, TopicStyle style, MoverInfo& mover, std::vector<std::string>& notes) {
  const std::string prefix = style == TopicStyle::nav2 || mover.plain ? "" : mover.frame + "/";
  mover.space = mover.plain ? "" : "/" + mover.frame;
  mover.base_frame = prefix + "base_link";
  mover.odom_frame = prefix + "odom";
  Taken topics =
      taken_names({"odom", "cmd_vel", "ground_truth", "state_quality", "tf", "tf_static", "map", "bodies"}, 1);
  if (mover.plain)
    for (const char* shared : {"run", "fleet", "clock", "walls", "lights", "faults"}) topics.emplace(shared, 1);
  Taken frames = taken_names({"odom", "base_link", "base_footprint", "map", "world"}, 1);
  std::map<std::string, int> counts;  // of sensors by type
  for (SensorInfo& sensor : mover.sensors) {
    const SensorTypeInfo& type = sensor_type_of(info, sensor);
    const std::string name = ros_name(topic_word(type, sensor), "sensor");
    const int number = counts[name]++;
    const std::string topic = unique(name, topics, 1);
    if (info.record_readings && topic != (number == 0 ? name : name + "_" + std::to_string(number)))
      notes.push_back(fmt::format("sensor '{}' of '{}' has the topic {}/{}, since an earlier name is taken",
                                  sensor.name, mover.name, mover.space, topic));
    sensor.topic = mover.space + "/" + topic;
    sensor.frame = prefix + unique(ros_name(type.name, "sensor"), frames, 1);
    name_standard_topics(sensor, sensor.topic);
    for (StandardTopic& each : sensor.standard)
      if (each.message == StandardTopic::Message::imu) each.topic = mover.space + "/" + unique("imu", topics, 1);
  }
}

}  // namespace

void put_naming(const Naming& naming, RunInfo& info) {
  const Naming standard;
  for (const auto& [word, style] : kTopicStyles)
    if (naming.style == style && style != standard.style) info.options.emplace_back(kStyleOption, word);
  for (const auto& [word, source] : kOdometrySources)
    if (naming.odometry == source && source != standard.odometry) info.options.emplace_back(kOdometryOption, word);
  std::string nodes;
  for (const auto& [word, member] : kExternalNodes)
    if (naming.*member) nodes += (nodes.empty() ? "" : ",") + std::string(word);
  if (!nodes.empty()) info.options.emplace_back(kExternalOption, nodes);
}

Naming naming_of(const RunInfo& info) {
  Naming naming;
  for (const auto& [word, style] : kTopicStyles)
    if (option_of(info, kStyleOption) == word) naming.style = style;
  for (const auto& [word, source] : kOdometrySources)
    if (option_of(info, kOdometryOption) == word) naming.odometry = source;
  for (const auto& [word, member] : kExternalNodes)
    naming.*member = option_of(info, kExternalOption).find(word) != std::string_view::npos;
  if (naming.style == TopicStyle::sensor) naming.odometry = OdometrySource::truth;
  return naming;
}

std::vector<std::string> name_frames(RunInfo& info) {
  const TopicStyle style = naming_of(info).style;
  Taken robots = taken_names({"world", "run", "fleet", "clock", "map", "walls", "bodies"}, 2);
  if (style != TopicStyle::sensor)
    for (const char* name : {"lights", "tf", "tf_static", "odom", "base_link", "base_footprint", "sensorfarm", "rosout",
                             "parameter_events"})
      robots.emplace(name, 2);
  std::vector<std::string> notes;
  for (MoverInfo& mover : info.movers) {
    const std::string name =
        style == TopicStyle::sensor ? plain_ros_name(mover.name, "robot") : ros_name(mover.name, "robot");
    mover.frame = unique(name, robots, 2);
    if (mover.frame != name)
      notes.push_back(fmt::format("robot '{}' is /{}, since /{} is taken", mover.name, mover.frame, name));
    if (style == TopicStyle::sensor)
      name_by_sensors(info, mover);
    else
      name_by_types(info, style, mover, notes);
  }
  return notes;
}

}  // namespace sf::record
