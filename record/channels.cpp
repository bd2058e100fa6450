#include "record/channels.h"

#include <map>
#include <string_view>

#include "record/reading_messages.h"
#include "record/schemas.h"

namespace sf::record {

namespace {

// Metadata required by rosbag2: "" selects the reader's defaults; latched topics need an explicit profile.
const TextPairs kPlain = {{"offered_qos_profiles", ""}};
const TextPairs kLatched = {
    {"offered_qos_profiles",
     "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline:\n    sec: 0\n    nsec: 0\n"
     "  lifespan:\n    sec: 0\n    nsec: 0\n  liveliness: 1\n  liveliness_lease_duration:\n"
     "    sec: 0\n    nsec: 0\n  avoid_ros_namespace_conventions: false\n"}};

/// The frame of the topic "/robot/laser/scan" is "robot/laser".
Scan header_of(const SensorInfo& sensor) {
  return {.frame = sensor.topic.substr(1, sensor.topic.rfind('/') - 1),
          .fov = static_cast<float>(sensor.fov),
          .scan_time = static_cast<float>(1.0 / sensor.rate),
          .range_min = static_cast<float>(sensor.range_min),
          .range_max = static_cast<float>(sensor.range_max)};
}

std::uint16_t add_schema(McapWriter& mcap, std::string_view type) {
  return mcap.add_schema(type, "ros2msg", schema_text(type));
}

void add_motion(McapWriter& mcap, const RunInfo& info, Channels& channels) {
  const std::uint16_t odometry = add_schema(mcap, kOdometry);
  const std::uint16_t twist = add_schema(mcap, kTwistStamped);
  for (std::size_t row = 0; row < info.movers.size(); ++row) {
    const std::string topic = "/" + info.movers[row].frame;
    channels.movers[row].odometry = mcap.add_channel(odometry, topic + "/odom", "cdr", kPlain);
    channels.movers[row].command = mcap.add_channel(twist, topic + "/cmd_vel", "cdr", kPlain);
  }
}

void add_qualities(McapWriter& mcap, const RunInfo& info, Channels& channels) {
  const std::uint16_t quality = add_schema(mcap, kStateQuality);
  for (std::size_t row = 0; row < info.movers.size(); ++row)
    channels.movers[row].quality =
        mcap.add_channel(quality, "/" + info.movers[row].frame + "/state_quality", "cdr", kPlain);
}

void add_readings(McapWriter& mcap, const RunInfo& info, Channels& channels) {
  const std::uint16_t scan = add_schema(mcap, kLaserScan);
  std::map<std::uint8_t, std::uint16_t> schemas;  // by sensor type
  for (const SensorTypeInfo& type : info.sensor_types)
    schemas[type.id] = type.is_scan ? scan : mcap.add_schema(type_of(type), "ros2msg", schema_text(type));
  for (std::size_t row = 0; row < info.movers.size(); ++row) {
    const MoverInfo& mover = info.movers[row];
    for (std::size_t i = 0; i < mover.sensors.size(); ++i)
      channels.movers[row].sensors[i].channel =
          mcap.add_channel(schemas.at(mover.sensors[i].type), mover.sensors[i].topic, "cdr", kPlain);
  }
}

void add_frames(const RunInfo& info, Channels& channels) {
  for (const MoverInfo& mover : info.movers) {
    MoverChannels& row = channels.movers.emplace_back();
    for (const SensorInfo& sensor : mover.sensors)
      row.sensors.push_back({0, find_sensor_type(info, sensor.type), header_of(sensor)});
  }
}

}  // namespace

std::size_t count_channels(const RunInfo& info) {
  std::size_t count = info.lights.empty() ? 4 : 5;
  for (const MoverInfo& mover : info.movers)
    count += 2 + (info.estimated ? 1 : 0) + (info.record_readings ? mover.sensors.size() : 0);
  return count;
}

Channels add_channels(McapWriter& mcap, const RunInfo& info) {
  Channels channels;
  channels.info = mcap.add_channel(add_schema(mcap, kRunInfo), "/run", "cdr", kLatched);
  channels.fleet = mcap.add_channel(add_schema(mcap, kFleet), "/fleet", "cdr", kPlain);
  const std::uint16_t transforms = add_schema(mcap, kTransforms);
  channels.transforms = mcap.add_channel(transforms, "/tf", "cdr", kPlain);
  channels.statics = mcap.add_channel(transforms, "/tf_static", "cdr", kLatched);
  if (!info.lights.empty()) channels.lights = mcap.add_channel(add_schema(mcap, kLights), "/lights", "cdr", kPlain);
  add_frames(info, channels);
  if (info.odometry_rate > 0.0) add_motion(mcap, info, channels);
  if (info.estimated) add_qualities(mcap, info, channels);
  if (info.record_readings) add_readings(mcap, info, channels);
  return channels;
}

}  // namespace sf::record
