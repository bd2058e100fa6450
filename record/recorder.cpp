#include "record/recorder.h"

#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "record/fleet_message.h"
#include "record/lights_message.h"
#include "record/reading_messages.h"

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
  return pairs;
}

}  // namespace

Recorder::Recorder(const std::string& directory, RunInfo info)
    : info_(named(std::move(info))), file_(directory + "/run.mcap"), mcap_("ros2", "sensorfarm") {
  if (count_channels(info_) > kMaxChannels) {
    throw base::InputError(file_.path(), 0,
                           "needs " + std::to_string(count_channels(info_)) +
                               " topics, and a file holds 65535: record fewer robots, or no readings");
  }
  mcap_.add_attachment({.name = "world.bin", .media_type = "application/octet-stream", .data = info_.snapshot});
  mcap_.add_metadata({"sensorfarm", summary_of(info_)});
  channels_ = add_channels(mcap_, info_);
  write_run_info();
  write_sensor_frames();
  flush();
  file_.publish();
  info_.snapshot = {};
}

Recorder::~Recorder() {
  try {
    finish();
  } catch (const base::InputError&) {
    // All ticks whose `write` returned are in the file; only the summary is missing.
  }
}

void Recorder::write_run_info() {
  message_.clear();
  encode_run_info(info_, message_);
  add(channels_.info, 0, 0, 0);
}

void Recorder::write_sensor_frames() {
  transforms_.clear();
  for (std::size_t row = 0; row < info_.movers.size(); ++row) {
    const MoverInfo& mover = info_.movers[row];
    for (std::size_t k = 0; k < mover.sensors.size(); ++k)
      transforms_.push_back({0, mover.frame, channels_.movers[row].sensors[k].header.frame, mover.sensors[k].X_MS});
  }
  message_.clear();
  encode_transforms(transforms_, message_);
  add(channels_.statics, 0, 0, 0);
}

void Recorder::write(const base::TickRecord& record) {
  SF_CHECK(!finished_, "tick " + std::to_string(record.tick) + " after the end of the recording");
  for (const base::Report& report : record.reports) {
    SF_CHECK(report.mover < channels_.movers.size(), "mover " + std::to_string(report.mover));
  }
  message_.clear();
  encode_fleet(record, message_);
  add(channels_.fleet, ticks_, record.time, record.time);
  write_transforms(record);
  if (!record.lights.empty()) write_lights(record);
  if (info_.odometry_rate > 0.0 && record.time >= next_odometry_) write_odometry(record);
  if (info_.estimated) write_qualities(record);
  if (info_.record_readings)
    for (const base::ReadingBlock& reading : record.readings) write_reading(reading, record.time);
  flush();
  ++ticks_;
}

void Recorder::write_transforms(const base::TickRecord& record) {
  transforms_.clear();
  for (const base::Report& report : record.reports) {
    if (base::is_absent(report.X_WM)) continue;
    transforms_.push_back({record.time, "world", info_.movers[report.mover].frame, report.X_WM});
  }
  message_.clear();
  encode_transforms(transforms_, message_);
  add(channels_.transforms, ticks_, record.time, record.time);
}

void Recorder::write_lights(const base::TickRecord& record) {
  message_.clear();
  encode_lights(record.time, info_.lights, record.lights, message_);
  add(channels_.lights, ticks_, record.time, record.time);
}

void Recorder::write_qualities(const base::TickRecord& record) {
  SF_CHECK(record.qualities.size() == record.reports.size(), std::to_string(record.qualities.size()));
  for (std::size_t i = 0; i < record.reports.size(); ++i) {
    if (!record.qualities[i].stated) continue;
    const std::uint32_t mover = record.reports[i].mover;
    message_.clear();
    encode_state_quality(record.time, info_.movers[mover].frame, record.qualities[i], message_);
    add(channels_.movers[mover].quality, ticks_, record.time, record.time);
  }
}

void Recorder::write_odometry(const base::TickRecord& record) {
  for (std::size_t i = 0; i < record.reports.size(); ++i) {
    const base::Report& report = record.reports[i];
    if (base::is_absent(report.X_WM)) continue;
    const std::string& frame = info_.movers[report.mover].frame;
    message_.clear();
    encode_odometry({record.time, "world", frame, report.X_WM}, report.velocity, message_);
    add(channels_.movers[report.mover].odometry, odometries_, record.time, record.time);
    if (record.commands.empty()) continue;
    message_.clear();
    encode_twist(record.time, frame, record.commands[i], message_);
    add(channels_.movers[report.mover].command, odometries_, record.time, record.time);
  }
  ++odometries_;
  const auto period = std::max<std::int64_t>(1, std::llround(1e9 / info_.odometry_rate));
  next_odometry_ = (record.time / period + 1) * period;
}

void Recorder::write_reading(const base::ReadingBlock& reading, std::int64_t time) {
  SF_CHECK(reading.mover < channels_.movers.size(), "mover " + std::to_string(reading.mover));
  std::uint32_t before = 0;  // sensors of the same type before this one
  for (SensorChannel& sensor : channels_.movers[reading.mover].sensors) {
    if (sensor.type->id != reading.type || before++ < reading.sensor) continue;
    message_.clear();
    sensor.header.time = reading.time;
    sensor.type->is_scan ? encode_scan(sensor.header, reading.values, message_)
                         : encode_reading(*sensor.type, reading.time, sensor.header.frame, reading.values, message_);
    add(sensor.channel, reading.sequence, time, reading.time);
    return;
  }
  SF_CHECK(false, "mover " + std::to_string(reading.mover) + " type " + std::to_string(reading.type) + " sensor " +
                      std::to_string(reading.sensor));
}

void Recorder::add(std::uint16_t channel, std::uint32_t sequence, std::int64_t log_time, std::int64_t true_time) {
  SF_CHECK(log_time >= 0 && true_time >= 0, std::to_string(log_time) + " ns, " + std::to_string(true_time) + " ns");
  mcap_.add_message({.channel = channel,
                     .sequence = sequence,
                     .log_time = static_cast<std::uint64_t>(log_time),
                     .publish_time = static_cast<std::uint64_t>(true_time),
                     .data = message_});
}

void Recorder::flush() {
  mcap_.end_chunk();
  finished_ = true;  // reset when the bytes are in the file: a failure is final
  file_.append(mcap_.pending());
  finished_ = false;
  mcap_.drained();
}

void Recorder::finish() {
  if (finished_) return;
  mcap_.finish();
  finished_ = true;
  file_.append(mcap_.pending());
  file_.sync();
}

}  // namespace sf::record
