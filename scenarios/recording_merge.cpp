#include "scenarios/recording_merge.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <unordered_map>

#include "base/error.h"
#include "farm/reading_order.h"
#include "record/mcap_reader.h"
#include "record/mcap_writer.h"
#include "record/recorder.h"
#include "record/recording_files.h"
#include "world/world.h"

namespace sf::scenarios {

namespace {

namespace fs = std::filesystem;
using record::McapMessage;
using Sink = std::function<void(std::span<const std::uint8_t>)>;

/// The recording of one rank. Its ticks begin with /fleet (the first rank) or /clock (all others). No tick is split,
/// because each is a chunk.
struct Part {
  std::string name;
  record::MappedFile file;
  record::McapContents contents;
  unsigned number = 0, parts = 0;
  std::vector<std::size_t> ticks;  ///< first message of each tick, plus the end

  explicit Part(const std::string& path) : name(path), file(path), contents(record::read_mcap(file.bytes(), path)) {
    const auto found = std::find_if(contents.metadata.begin(), contents.metadata.end(),
                                    [](const record::McapMetadata& m) { return m.name == record::kPartMetadata; });
    if (found != contents.metadata.end())
      for (const auto& [key, value] : found->pairs)
        (key == "part" ? number : parts) = static_cast<unsigned>(std::strtoul(value.c_str(), nullptr, 10));
    if (parts < 2 || number >= parts)
      throw base::InputError(
          name, 0, "not the recording of a rank: expected one written by `mpirun -n N sensorfarm run --record`");
    find_ticks();
  }

  const std::string& topic(const McapMessage& message) const { return contents.channels.at(message.channel).topic; }
  const McapMessage& message(std::size_t at) const { return contents.messages[at]; }

 private:
  void find_ticks() {
    const std::string start = number == 0 ? "/fleet" : "/clock";
    for (std::size_t i = 0; i < contents.messages.size(); ++i)
      if (topic(message(i)) == start) ticks.push_back(i);
    ticks.push_back(contents.messages.size());
  }
};

using Parts = std::vector<std::unique_ptr<Part>>;

std::vector<std::string> files_at(const std::string& place) {
  std::error_code ignored;
  if (!fs::is_directory(place, ignored)) return {place};
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(place, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("rank-") && name.ends_with(".mcap")) files.push_back(entry.path().string());
  }
  if (files.empty())
    throw base::InputError(place, 0,
                           "has no recordings of ranks (rank-0.mcap and so on), which `run` writes when "
                           "several ranks record with --record-readings");
  std::sort(files.begin(), files.end());
  return files;
}

/// Returns all parts by number. If an earlier job in the same folder had more ranks, the file of the first rank gives
/// the number of valid parts.
Parts open_parts(std::span<const std::string> places) {
  std::map<unsigned, std::unique_ptr<Part>> found;
  for (const std::string& place : places)
    for (const std::string& file : files_at(place)) {
      auto part = std::make_unique<Part>(file);
      const auto [at, is_new] = found.try_emplace(part->number, nullptr);
      if (!is_new)
        throw base::InputError(file, 0, "belongs to the same rank as " + at->second->name + ": give one of them");
      at->second = std::move(part);
    }
  if (!found.contains(0)) throw base::InputError("the recording of rank 0 is missing: rank-0.mcap has the states");
  const unsigned parts = found.at(0)->parts;
  Parts all;
  for (unsigned number = 0; number < parts; ++number) {
    const auto at = found.find(number);
    if (at == found.end())
      throw base::InputError(
          fmt::format("the recording of rank {} of {} is missing: rank-{}.mcap", number, parts, number));
    if (at->second->parts != parts)
      throw base::InputError(
          at->second->name, 0,
          fmt::format("belongs to a run with {} ranks, but rank 0's to one with {}", at->second->parts, parts));
    all.push_back(std::move(at->second));
  }
  return all;
}

/// Compares messages and world to check that two parts belong to the same run.
void check_same_run(const Part& first, const Part& other) {
  const auto same = [](std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  };
  const auto& a = first.contents;
  const auto& b = other.contents;
  const bool together = !a.messages.empty() && !b.messages.empty() && !a.attachments.empty() &&
                        !b.attachments.empty() && a.channels.size() == b.channels.size() &&
                        same(a.messages[0].data, b.messages[0].data) &&
                        same(a.attachments[0].data, b.attachments[0].data);
  if (!together) throw base::InputError(other.name, 0, "belongs to another run than " + first.name);
}

/// Writes the parts as one recording.
class Merger {
 public:
  Merger(const Parts& parts, record::Compression compression, Sink sink)
      : parts_(parts),
        sink_(std::move(sink)),
        mcap_(parts[0]->contents.profile, parts[0]->contents.library, compression) {
    for (const auto& part : parts) check_same_run(*parts[0], *part);
    find_sensors();
    write_head();
  }

  std::uint64_t ticks() const {
    std::size_t least = parts_[0]->ticks.size();
    for (const auto& part : parts_) least = std::min(least, part->ticks.size());
    return least - 1;
  }

  void write(const std::function<bool()>& stop) {
    for (std::uint64_t tick = 0; tick < ticks(); ++tick) {
      if (stop && stop()) throw base::Interrupted();
      write_tick(tick);
    }
    mcap_.finish();
    flush();
  }

 private:
  /// The messages of one reading, which are consecutive.
  struct Reading {
    farm::ReadingOrder::Key key;
    const Part* part;
    std::size_t first, end;
  };

  void find_sensors();
  void write_head();
  void write_tick(std::uint64_t tick);
  void find_readings(const Part& part, std::uint64_t tick);
  void flush() {
    mcap_.end_chunk();
    sink_(mcap_.pending());
    mcap_.drained();
  }

  const Parts& parts_;
  Sink sink_;
  record::McapWriter mcap_;
  std::unique_ptr<farm::ReadingOrder> order_;
  std::unordered_map<std::uint16_t, std::uint32_t> sensors_;  ///< number of the sensor, by channel of readings
  std::set<std::uint16_t> with_readings_;                     ///< these channels and those of standard messages
  std::vector<Reading> readings_;
};

void Merger::find_sensors() {
  const record::RunInfo info = record::run_info_of(parts_[0]->contents, parts_[0]->name);
  const world::World world = world::from_snapshot(info.snapshot);
  const sensors::SensorSet sensor_set(world);
  order_ = std::make_unique<farm::ReadingOrder>(sensor_set);
  std::unordered_map<std::string, std::uint32_t> topics;
  for (std::uint32_t mover = 0; mover < info.movers.size(); ++mover) {
    std::map<std::uint8_t, std::uint32_t> before;  // by type
    for (const record::SensorInfo& sensor : info.movers[mover].sensors)
      topics[sensor.topic] = order_->sensor_of(sensor.type, mover, before[sensor.type]++);
  }
  // Topics of readings are last, each before its standard topics.
  bool readings = false;
  for (const auto& [id, channel] : parts_[0]->contents.channels) {
    const auto found = topics.find(channel.topic);
    readings = readings || found != topics.end();
    if (readings) with_readings_.insert(id);
    if (found != topics.end()) sensors_[id] = found->second;
  }
}

void Merger::write_head() {
  const record::McapContents& contents = parts_[0]->contents;
  for (const record::McapAttachment& attachment : contents.attachments) mcap_.add_attachment(attachment);
  for (const record::McapMetadata& metadata : contents.metadata)
    if (metadata.name != record::kPartMetadata) mcap_.add_metadata(metadata);
  std::map<std::uint16_t, std::uint16_t> schemas;
  for (const auto& [id, channel] : contents.channels) {
    const auto [at, is_new] = schemas.try_emplace(channel.schema, std::uint16_t{0});
    const record::McapSchema& schema = contents.schemas.at(channel.schema);
    if (is_new) at->second = mcap_.add_schema(schema.name, schema.encoding, schema.text);
    mcap_.add_channel(at->second, channel.topic, channel.encoding, channel.metadata);
  }
  for (std::size_t i = 0; i < parts_[0]->ticks[0]; ++i) mcap_.add_message(parts_[0]->message(i));
  flush();
}

void Merger::write_tick(std::uint64_t tick) {
  readings_.clear();
  for (const auto& part : parts_) find_readings(*part, tick);
  std::stable_sort(readings_.begin(), readings_.end(),
                   [](const Reading& a, const Reading& b) { return a.key < b.key; });
  const Part& first = *parts_[0];
  for (std::size_t i = first.ticks[tick]; i < first.ticks[tick + 1]; ++i)
    if (!with_readings_.contains(first.message(i).channel)) mcap_.add_message(first.message(i));
  for (const Reading& reading : readings_)
    for (std::size_t i = reading.first; i < reading.end; ++i) mcap_.add_message(reading.part->message(i));
  flush();
}

void Merger::find_readings(const Part& part, std::uint64_t tick) {
  for (std::size_t i = part.ticks[tick]; i < part.ticks[tick + 1]; ++i) {
    const McapMessage& message = part.message(i);
    if (!with_readings_.contains(message.channel)) continue;
    const auto sensor = sensors_.find(message.channel);
    if (sensor != sensors_.end())
      readings_.push_back(
          {order_->key(sensor->second, static_cast<std::int64_t>(message.publish_time)), &part, i, i + 1});
    else if (!readings_.empty())
      readings_.back().end = i + 1;
  }
}

}  // namespace

MergedRecording merge_recordings(std::span<const std::string> places, const std::string& folder,
                                 const std::function<bool()>& stop) {
  const Parts parts = open_parts(places);
  MergedRecording merged;
  for (const auto& part : parts) {
    if (part->contents.truncated && part->ticks.size() == 1)
      throw base::InputError(part->name, 0, "was cut off before its first tick: nothing to merge");
  }
  record::GrowingFile file(folder + "/" + record::RecordingPart{}.file());
  const record::Compression compression = parts[0]->contents.compression.value_or(record::Compression::none);
  Merger merger(parts, compression, [&](std::span<const std::uint8_t> bytes) { file.append(bytes); });
  merger.write(stop);
  file.sync();
  file.publish();
  merged.file = file.path();
  merged.ticks = merger.ticks();
  merged.bytes = file.size();
  for (const auto& part : parts) {
    merged.truncated = merged.truncated || part->contents.truncated;
    for (const std::string& damage : part->contents.damage) merged.damage.push_back(part->name + ": " + damage);
  }
  return merged;
}

record::Recording open_run(const std::string& place) {
  std::error_code ignored;
  const fs::path folder = place;
  if (!fs::exists(folder / "rank-0.mcap", ignored) || fs::exists(folder / "run.mcap", ignored))
    return record::open_recording(place);
  const Parts parts = open_parts(std::span(&place, 1));
  base::Bytes bytes;
  Merger(parts, record::Compression::none, [&](std::span<const std::uint8_t> more) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  }).write({});
  record::Recording recording = record::read_recording(bytes, parts[0]->name);
  for (const auto& part : parts) {
    recording.truncated = recording.truncated || part->contents.truncated;
    recording.damage.insert(recording.damage.end(), part->contents.damage.begin(), part->contents.damage.end());
  }
  return recording;
}

}  // namespace sf::scenarios
