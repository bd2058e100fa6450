#include "record/recording.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>

#include "base/error.h"
#include "record/faults_message.h"
#include "record/lights_message.h"
#include "record/mcap_reader.h"
#include "record/reading_messages.h"
#include "record/recorder.h"
#include "record/recording_files.h"
#include "record/ros_messages.h"
#include "record/schemas.h"

namespace sf::record {

namespace {

/// The sensor of a topic.
struct SensorTopic {
  std::uint32_t mover = 0;
  const SensorTypeInfo* type = nullptr;
  std::uint32_t sensor = 0;          ///< 0-based among the mover's sensors of its type
  const SensorInfo* info = nullptr;  ///< in `RunInfo::movers`
};
using Topics = std::map<std::string, SensorTopic>;

std::string file_in(const std::string& directory) {
  std::error_code ignored;
  const std::filesystem::path path = directory;
  if (std::filesystem::is_regular_file(path, ignored)) return directory;
  const std::string file = (path / "run.mcap").string();
  if (!std::filesystem::exists(file, ignored)) {
    throw base::InputError(file, 0, "no such recording: give the directory of a run that was recorded with --record");
  }
  return file;
}

std::string_view type_of(const McapContents& contents, const McapMessage& message) {
  const McapChannel& channel = contents.channels.at(message.channel);
  const auto schema = contents.schemas.find(channel.schema);
  const bool ours = channel.encoding == "cdr" && schema != contents.schemas.end();
  return ours ? std::string_view(schema->second.name) : std::string_view();
}

Topics sensor_topics(const RunInfo& info) {
  Topics topics;
  for (std::uint32_t mover = 0; mover < info.movers.size(); ++mover) {
    std::map<std::uint8_t, std::uint32_t> before;  // by sensor type
    for (const SensorInfo& sensor : info.movers[mover].sensors) {
      const SensorTypeInfo* type = find_sensor_type(info, sensor.type);
      if (type != nullptr) topics[sensor.topic] = {mover, type, before[sensor.type]++, &sensor};
    }
  }
  return topics;
}

bool is_before_joining(const Recording& recording, std::size_t row) {
  return recording.states[row].size() == recording.ticks &&
         (recording.states[row].empty() || base::is_absent(recording.states[row].back().X_WM));
}

bool read_fleet(const McapMessage& message, FleetState& fleet, Recording& recording) {
  if (!decode_fleet(message.data, fleet)) return false;
  const auto known = [&](const MoverState& state) { return state.mover < recording.states.size(); };
  if (!std::all_of(fleet.states.begin(), fleet.states.end(), known)) return false;
  for (const MoverState& state : fleet.states) {
    recording.states[state.mover].push_back(
        {fleet.tick, fleet.time, state.contact, state.X_WM, state.velocity, state.command});
  }
  // Adds robots that join later.
  for (std::size_t row = recording.states.size() - recording.info.joined.size(); row < recording.states.size(); ++row)
    if (is_before_joining(recording, row))
      recording.states[row].push_back({fleet.tick, fleet.time, false, base::kAbsent, {}, {}});
  ++recording.ticks;
  recording.end_time = fleet.time;
  return true;
}

/// Adds values to the states of their tick, which is the last one read, unless its states are damaged.
template <class Value>
bool add_values(const MoverValues<Value>& sample, Value StateSample::*value, Recording& recording) {
  for (const MoverValue<Value>& each : sample.movers) {
    if (each.mover >= recording.states.size()) return false;
    auto& states = recording.states[each.mover];
    if (!states.empty() && states.back().time == sample.time) states.back().*value = each.value;
  }
  return true;
}

bool read_tilts(const McapMessage& message, Recording& recording) {
  TiltsSample sample;
  return decode_tilts(message.data, sample) && add_values(sample, &StateSample::tilt, recording);
}

bool read_wheels(const McapMessage& message, Recording& recording) {
  WheelsSample sample;
  return decode_wheels(message.data, sample) && add_values(sample, &StateSample::wheels, recording);
}

/// Beams without a return are infinite in messages; in the run they may have been `range_max`.
bool read_scan(const McapMessage& message, const SensorTopic& topic, const RunInfo& info, ReadingSample& sample) {
  const std::optional<Scan> scan = decode_scan(message.data);
  if (!scan) return false;
  const double none = option_of(info, kNoReturn) == "inf" ? HUGE_VAL : topic.info->range_max;
  sample.time = scan->time;
  sample.width = 1;
  sample.values.assign(scan->ranges.begin(), scan->ranges.end());
  std::replace(sample.values.begin(), sample.values.end(), HUGE_VAL, none);
  return true;
}

bool read_reading(const McapMessage& message, const SensorTopic& topic, Recording& recording) {
  ReadingSample sample{
      topic.mover, topic.type->id, topic.sensor, message.sequence, static_cast<std::int64_t>(message.log_time), 0, 0,
      {}};
  if (!(topic.type->is_scan ? read_scan(message, topic, recording.info, sample)
                            : decode_reading(*topic.type, message.data, sample.time, sample.values, &sample.width)))
    return false;
  recording.readings.push_back(std::move(sample));
  return true;
}

/// @return false if a message of a known type is malformed; unknown types are not damage
bool read_message(const McapMessage& message, std::string_view type, const std::string& name, const Topics& topics,
                  FleetState& fleet, Recording& recording) {
  if (type == kFleet) return read_fleet(message, fleet, recording);
  if (type == kTilts) return read_tilts(message, recording);
  if (type == kWheels) return read_wheels(message, recording);
  if (type == kLights) {
    LightsSample& sample = recording.lights.emplace_back();
    const bool good = decode_lights(message.data, sample.time, sample.lights);
    if (!good) recording.lights.pop_back();
    return good;
  }
  if (type == kShapes) {
    ShapesSample& sample = recording.shapes.emplace_back();
    const bool good = decode_shapes(message.data, sample);
    if (!good) recording.shapes.pop_back();
    return good;
  }
  if (type == kFaults) return decode_faults(message.data, recording.faults);
  const auto found = topics.find(name);
  if (found == topics.end()) return type != kLaserScan;
  return type == type_of(*found->second.type) && read_reading(message, found->second, recording);
}

void read_messages(const McapContents& contents, Recording& recording) {
  constexpr std::size_t kMaxDamage = 100;
  const Topics topics = sensor_topics(recording.info);
  recording.states.resize(recording.info.movers.size());
  FleetState fleet;
  for (const McapMessage& message : contents.messages) {
    const std::string& name = contents.channels.at(message.channel).topic;
    if (read_message(message, type_of(contents, message), name, topics, fleet, recording)) continue;
    if (recording.damage.size() >= kMaxDamage) continue;
    recording.damage.push_back(name + " at " + std::to_string(message.log_time) + " ns: malformed, left out");
  }
}

}  // namespace

RunInfo run_info_of(const McapContents& contents, const std::string& name) {
  RunInfo info, first;
  const std::string cause = contents.damage.empty() ? "" : "; damaged at " + contents.damage.front();
  const auto is_info = [&](const McapMessage& message) { return type_of(contents, message) == kRunInfo; };
  const auto found = std::find_if(contents.messages.begin(), contents.messages.end(), is_info);
  if (found == contents.messages.end() || !decode_run_info(found->data, first)) {
    throw base::InputError(
        name, 0, "not a sensorfarm recording: expected a readable " + std::string(kRunInfo) + " message" + cause);
  }
  info = first;
  // Robots that join are listed in a further message.
  for (auto later = found;
       (later = std::find_if(later + 1, contents.messages.end(), is_info)) != contents.messages.end();)
    if (RunInfo more; decode_run_info(later->data, more) && more.movers.size() >= info.movers.size())
      info = std::move(more);
  for (const McapMetadata& metadata : contents.metadata) {
    if (metadata.name != kJoinedMetadata || first.movers.size() + info.joined.size() == info.movers.size()) continue;
    if (auto joined = joined_mover_of(metadata.pairs)) info.joined.push_back(std::move(*joined));
  }
  const auto world = std::find_if(contents.attachments.begin(), contents.attachments.end(),
                                  [](const McapAttachment& attachment) { return attachment.name == "world.bin"; });
  if (world == contents.attachments.end() || world->data.empty()) {
    throw base::InputError(name, 0, "no complete world inside: expected an attachment world.bin" + cause);
  }
  info.snapshot.assign(world->data.begin(), world->data.end());
  return info;
}

Recording open_recording(const std::string& directory) {
  const std::string name = file_in(directory);
  const MappedFile file(name);
  return read_recording(file.bytes(), name);
}

Recording read_recording(std::span<const std::uint8_t> bytes, const std::string& name) {
  const McapContents contents = read_mcap(bytes, name);
  Recording recording;
  recording.file = name;
  recording.truncated = contents.truncated;
  recording.damage = contents.damage;
  recording.info = run_info_of(contents, name);
  read_messages(contents, recording);
  return recording;
}

}  // namespace sf::record
