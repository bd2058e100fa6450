#include "record/recording.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>

#include "base/error.h"
#include "record/file.h"
#include "record/mcap_reader.h"
#include "record/schemas.h"

namespace sf::record {

namespace {

/// Which mover and laser a topic belongs to.
struct ScanTopic {
  std::uint32_t mover = 0;
  std::uint32_t sensor = 0;
};

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

void read_info(const McapContents& contents, Recording& recording) {
  const auto found = std::find_if(contents.messages.begin(), contents.messages.end(),
                                  [&](const McapMessage& message) { return type_of(contents, message) == kRunInfo; });
  if (found == contents.messages.end() || !decode_run_info(found->data, recording.info)) {
    throw base::InputError(recording.file, 0,
                           "not a run of ours: expected a readable " + std::string(kRunInfo) + " message");
  }
  const auto world = std::find_if(contents.attachments.begin(), contents.attachments.end(),
                                  [](const McapAttachment& attachment) { return attachment.name == "world.bin"; });
  if (world == contents.attachments.end() || world->data.empty()) {
    throw base::InputError(recording.file, 0, "no whole world inside: expected an attachment world.bin");
  }
  recording.info.snapshot.assign(world->data.begin(), world->data.end());
}

std::map<std::string, ScanTopic> scan_topics(const RunInfo& info) {
  std::map<std::string, ScanTopic> topics;
  for (std::uint32_t mover = 0; mover < info.movers.size(); ++mover) {
    const auto& lasers = info.movers[mover].lasers;
    for (std::uint32_t sensor = 0; sensor < lasers.size(); ++sensor) topics[lasers[sensor].topic] = {mover, sensor};
  }
  return topics;
}

bool read_fleet(const McapMessage& message, FleetState& fleet, Recording& recording) {
  if (!decode_fleet(message.data, fleet)) return false;
  const auto known = [&](const MoverState& state) { return state.mover < recording.states.size(); };
  if (!std::all_of(fleet.states.begin(), fleet.states.end(), known)) return false;
  for (const MoverState& state : fleet.states) {
    recording.states[state.mover].push_back(
        {fleet.tick, fleet.time, state.contact, state.X_WM, state.velocity, state.command});
  }
  ++recording.ticks;
  recording.end_time = fleet.time;
  return true;
}

bool read_scan(const McapMessage& message, const ScanTopic& topic, Recording& recording) {
  std::optional<Scan> scan = decode_scan(message.data);
  if (!scan) return false;
  recording.scans.push_back(
      {topic.mover, topic.sensor, message.sequence, static_cast<std::int64_t>(message.log_time), std::move(*scan)});
  return true;
}

void read_messages(const McapContents& contents, Recording& recording) {
  constexpr std::size_t kMostDamage = 100;
  const auto topics = scan_topics(recording.info);
  recording.states.resize(recording.info.movers.size());
  FleetState fleet;
  for (const McapMessage& message : contents.messages) {
    const std::string_view type = type_of(contents, message);
    const std::string& topic = contents.channels.at(message.channel).topic;
    bool understood = true;
    if (type == kFleet) understood = read_fleet(message, fleet, recording);
    if (type == kLaserScan) {
      const auto found = topics.find(topic);
      understood = found != topics.end() && read_scan(message, found->second, recording);
    }
    if (understood || recording.damage.size() >= kMostDamage) continue;
    recording.damage.push_back(topic + " at " + std::to_string(message.log_time) + " ns: not understood, left out");
  }
}

}  // namespace

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
  read_info(contents, recording);
  read_messages(contents, recording);
  return recording;
}

}  // namespace sf::record
