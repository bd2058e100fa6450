#include "record/recorder.h"

#include <cstdio>
#include <map>
#include <span>
#include <string_view>

#include "base/error.h"
#include "base/hash.h"

namespace sf::record {

namespace {

constexpr std::size_t kMaxChannels = 0xFFFF;

RunInfo named(RunInfo info) {
  SF_CHECK(!info.snapshot.empty(), "a recording without its world");
  SF_CHECK(info.interval > 0.0 && info.odometry_rate >= 0.0, std::to_string(info.interval));
  name_frames(info);
  if (info.estimated) info.options.emplace_back("states", "estimated");  // read back by decode_run_info
  return info;
}

TextPairs summary_of(const RunInfo& info) {
  TextPairs pairs = {
      {"world", info.world},
      {"world_hash", base::hash_hex(info.world_hash)},
      {"seed", std::to_string(info.seed)},
      {"mode", info.mode},
      {"interval_s", std::to_string(info.interval)},
      {"movers", std::to_string(info.movers.size())},
      {"readings", info.record_readings ? "recorded" : "to be computed again from world.bin and /fleet"},
  };
  for (const auto& [key, value] : info.options) pairs.emplace_back("option." + key, value);
  for (std::size_t i = 0; i < info.accuracy.size(); ++i)
    pairs.emplace_back("accuracy." + std::to_string(i), info.accuracy[i]);
  return pairs;
}

// Metadata required by rosbag2: "" selects the reader's defaults; latched topics need an explicit profile.
const TextPairs kPlain = {{"offered_qos_profiles", ""}};
const TextPairs kLatched = {
    {"offered_qos_profiles",
     "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline:\n    sec: 0\n    nsec: 0\n"
     "  lifespan:\n    sec: 0\n    nsec: 0\n  liveliness: 1\n  liveliness_lease_duration:\n"
     "    sec: 0\n    nsec: 0\n  avoid_ros_namespace_conventions: false\n"}};

/// @return per topic, the id of its channel
std::vector<std::uint16_t> add_channels(McapWriter& mcap, std::span<const Topic> topics) {
  std::map<std::string_view, std::uint16_t> schemas;
  std::vector<std::uint16_t> channels;
  for (const Topic& topic : topics) {
    const auto [schema, is_new] = schemas.try_emplace(topic.type, std::uint16_t{0});
    if (is_new) schema->second = mcap.add_schema(topic.type, "ros2msg", topic.schema);
    channels.push_back(mcap.add_channel(schema->second, topic.name, "cdr", topic.latched ? kLatched : kPlain));
  }
  return channels;
}

}  // namespace

Recorder::Recorder(const std::string& directory, RunInfo info, const RecordingPart& part)
    : info_(named(std::move(info))),
      file_(directory + "/" + part.file()),
      mcap_("ros2", "sensorfarm " SF_VERSION, part.compression),
      messages_(info_) {
  if (messages_.topics().size() > kMaxChannels) {
    throw base::InputError(file_.path(), 0,
                           "needs " + std::to_string(messages_.topics().size()) +
                               " topics, and a file holds 65535: record fewer robots, or no readings");
  }
  mcap_.add_attachment({.name = "world.bin", .media_type = "application/octet-stream", .data = info_.snapshot});
  mcap_.add_metadata({"sensorfarm", summary_of(info_)});
  if (part.parts > 1)
    mcap_.add_metadata({kPartMetadata, {{"part", std::to_string(part.part)}, {"parts", std::to_string(part.parts)}}});
  if (part.part > 0) wanted_ = messages_.readings_and_clock();
  channels_ = add_channels(mcap_, messages_.topics());
  messages_.begin([this](const TopicMessage& message) { add(message); });
  flush();
  file_.publish();
  if (part.compression != Compression::none) writer_.emplace(mcap_, file_);
  // Another run's whole recording would be taken for this one's.
  if (part.parts > 1 && part.part == 0) std::remove((directory + "/" + RecordingPart{}.file()).c_str());
  info_.snapshot = {};
  info_.shape = {};
}

Recorder::~Recorder() {
  try {
    finish();
  } catch (const base::InputError&) {
    // All ticks whose `write` returned are in the file; only the summary is missing.
  }
}

void Recorder::write(const base::TickRecord& record) {
  SF_CHECK(!finished_, "tick " + std::to_string(record.tick) + " after the end of the recording");
  messages_.encode(
      record, [this](const TopicMessage& message) { add(message); }, wanted_);
  flush();
}

void Recorder::add(const TopicMessage& message) {
  SF_CHECK(message.log_time >= 0 && message.time >= 0,
           std::to_string(message.log_time) + " ns, " + std::to_string(message.time) + " ns");
  chunk_.add({.channel = channels_[message.topic],
              .sequence = message.sequence,
              .log_time = static_cast<std::uint64_t>(message.log_time),
              .publish_time = static_cast<std::uint64_t>(message.time),
              .data = message.bytes});
}

void Recorder::flush() {
  finished_ = true;  // reset when the bytes are in the file, or on their way: a failure is final
  if (writer_) {
    writer_->add(chunk_);
  } else {
    mcap_.write(chunk_);
    file_.append(mcap_.pending());
    mcap_.drained();
  }
  finished_ = false;
}

void Recorder::finish() {
  if (finished_) return;
  finished_ = true;
  if (writer_) writer_->finish();
  mcap_.finish();
  file_.append(mcap_.pending());
  file_.sync();
}

}  // namespace sf::record
