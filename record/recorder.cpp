#include "record/recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/hash.h"
#include "record/fleet_message.h"
#include "record/topic_names.h"

namespace sf::record {

namespace {

constexpr std::size_t kMaxChannels = 0xFFFF;

/// @param taken out: notes about names that are taken
RunInfo named(RunInfo info, const RecordingPart& part, std::vector<std::string>& taken) {
  SF_CHECK(!info.snapshot.empty(), "a recording without its world");
  SF_CHECK(info.interval > 0.0 && info.odometry_rate >= 0.0, std::to_string(info.interval));
  const bool has_encoders = std::any_of(info.movers.begin(), info.movers.end(),
                                        [](const MoverInfo& mover) { return mover.encoder.has_value(); });
  if (part.parts > 1 && has_encoders && naming_of(info).odometry == OdometrySource::encoders) {
    // A robot's readings are recorded by the rank that owns it, which changes with tiles.
    Naming exact;
    exact.odometry = OdometrySource::exact;
    put_naming(exact, info);
  }
  taken = name_frames(info);
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

/// Writes numbers as text that parses to the same doubles.
TextPairs pairs_of(const JoinedMover& mover) {
  TextPairs pairs = {{"name", mover.name}, {"like", std::to_string(mover.original)}};
  const base::Pose& X = mover.X_WM;
  for (const auto& [key, value] : {std::pair{"x", X.x}, {"y", X.y}, {"z", X.z}, {"yaw", X.yaw}})
    pairs.emplace_back(key, fmt::format("{}", value));
  return pairs;
}

}  // namespace

std::optional<JoinedMover> joined_mover_of(const TextPairs& pairs) {
  JoinedMover mover;
  int found = 0;
  const auto read = [&](const std::string& text, auto& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    found += error == std::errc() && end == text.data() + text.size();
  };
  base::Pose& X = mover.X_WM;
  for (const auto& [key, value] : pairs) {
    if (key == "name") mover.name = value;
    if (key == "like") read(value, mover.original);
    for (const auto& [name, number] : {std::pair{"x", &X.x}, {"y", &X.y}, {"z", &X.z}, {"yaw", &X.yaw}})
      if (key == name) read(value, *number);
  }
  const bool finite = std::isfinite(X.x + X.y + X.z + X.yaw);
  return found == 5 && finite ? std::optional(std::move(mover)) : std::nullopt;
}

Recorder::Recorder(const std::string& directory, RunInfo info, const RecordingPart& part)
    : info_(named(std::move(info), part, taken_names_)),
      file_(directory + "/" + part.file()),
      mcap_("ros2", "sensorfarm " SF_VERSION, part.compression),
      messages_(std::in_place, info_) {
  check_topics(*messages_);
  mcap_.add_attachment({.name = "world.bin", .media_type = "application/octet-stream", .data = info_.snapshot});
  mcap_.add_metadata({"sensorfarm", summary_of(info_)});
  if (part.parts > 1)
    mcap_.add_metadata({kPartMetadata, {{"part", std::to_string(part.part)}, {"parts", std::to_string(part.parts)}}});
  if (part.part > 0) wanted_ = messages_->readings_and_clock();
  add_channels();
  messages_->begin([this](const TopicMessage& message) { add(message); });
  flush();
  file_.publish();
  if (part.compression != Compression::none) start_writer();
  // Otherwise the complete recording of another run would be mistaken for this run's recording.
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
  time_ = record.time;
  const bool whole = wanted_.empty();
  bool new_topic = whole && !record.shapes.empty() && messages_->add_shapes();
  new_topic |= whole && any_tilted(record) && messages_->add_tilts();
  new_topic |= whole && any_wheels(record) && messages_->add_wheels();
  const bool threaded = new_topic && stop_writer();
  if (new_topic) add_channels();
  messages_->encode(
      record, [this](const TopicMessage& message) { add(message); }, wanted_);
  flush();
  if (threaded) start_writer();
}

/// Until a writer starts again, this thread owns the file.
/// @return whether there was one
bool Recorder::stop_writer() {
  const bool threaded = writer_.has_value();
  finished_ = true;  // reset when the writer has finished: a failure is final
  if (threaded) writer_->finish();
  writer_.reset();
  finished_ = false;
  return threaded;
}

void Recorder::start_writer() {
  try {
    writer_.emplace(mcap_, file_);
  } catch (const std::system_error&) {
    // The system cannot start another thread: `write` compresses and writes.
  }
}

void Recorder::check_topics(const TickMessages& messages) const {
  std::size_t count = channels_of_.size();
  for (const Topic& topic : messages.topics()) count += channels_of_.contains(topic.name) ? 0 : 1;
  if (count <= kMaxChannels) return;
  throw base::InputError(file_.path(), 0,
                         "needs " + std::to_string(count) +
                             " topics, but a file holds at most 65535: record fewer robots, or no readings");
}

/// Adds channels for the topics that do not have one yet.
void Recorder::add_channels() {
  channels_.clear();
  for (const Topic& topic : messages_->topics()) {
    const auto [schema, is_new_type] = schemas_.try_emplace(std::string(topic.type), std::uint16_t{0});
    if (is_new_type) schema->second = mcap_.add_schema(topic.type, "ros2msg", topic.schema);
    const auto [channel, is_new] = channels_of_.try_emplace(topic.name, std::uint16_t{0});
    if (is_new)
      channel->second = mcap_.add_channel(schema->second, topic.name, "cdr", topic.latched ? kLatched : kPlain);
    channels_.push_back(channel->second);
  }
}

void Recorder::add_movers(RunInfo info) {
  SF_CHECK(!finished_ && wanted_.empty(), "movers join a part of a recording, or after its end");
  info = named(std::move(info), {}, taken_names_);
  check_topics(TickMessages(info));
  const std::size_t known = info_.joined.size();
  const TickMessages before = std::move(*messages_);  // only its counts are used
  info_ = std::move(info);
  info_.snapshot = {};
  info_.shape = {};
  messages_.emplace(info_);
  if (before.has_shapes()) messages_->add_shapes();
  if (before.has_tilts()) messages_->add_tilts();
  if (before.has_wheels()) messages_->add_wheels();
  const bool threaded = stop_writer();
  for (std::size_t i = known; i < info_.joined.size(); ++i)
    mcap_.add_metadata({kJoinedMetadata, pairs_of(info_.joined[i])});
  add_channels();
  messages_->go_on(before, time_, [this](const TopicMessage& message) { add(message); });
  flush();
  if (threaded) start_writer();
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
  finished_ = true;  // reset when the bytes are in the file or handed to the thread: a failure is final
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
