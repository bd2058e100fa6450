#include "record/recorder.h"

#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "record/fleet.h"
#include "record/schemas.h"

namespace sf::record {

namespace {

constexpr std::uint8_t kLaser = 1;  // wire id of the kind
constexpr std::size_t kMostChannels = 0xFFFF;

// rosbag2 asks for these: "" means the reader's own choice; latched topics must say that they are.
const TextPairs kPlain = {{"offered_qos_profiles", ""}};
const TextPairs kLatched = {
    {"offered_qos_profiles",
     "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline:\n    sec: 0\n    nsec: 0\n"
     "  lifespan:\n    sec: 0\n    nsec: 0\n  liveliness: 1\n  liveliness_lease_duration:\n"
     "    sec: 0\n    nsec: 0\n  avoid_ros_namespace_conventions: false\n"}};

RunInfo named(RunInfo info) {
  SF_CHECK(!info.snapshot.empty(), "a recording without its world");
  SF_CHECK(info.interval > 0.0 && info.odometry_rate >= 0.0, std::to_string(info.interval));
  name_frames(info);
  return info;
}

std::size_t count_channels(const RunInfo& info) {
  std::size_t count = 4;
  for (const MoverInfo& mover : info.movers) count += 2 + (info.record_readings ? mover.lasers.size() : 0);
  return count;
}

TextPairs summary_of(const RunInfo& info) {
  TextPairs pairs = {
      {"world", info.world},
      {"world_hash", base::hash_text(info.world_hash)},
      {"seed", std::to_string(info.seed)},
      {"mode", info.mode},
      {"interval_s", std::to_string(info.interval)},
      {"movers", std::to_string(info.movers.size())},
      {"readings", info.record_readings ? "recorded" : "to be computed again from world.bin and /fleet"},
  };
  for (const auto& [key, value] : info.options) pairs.emplace_back("option." + key, value);
  return pairs;
}

/// "/robot/laser/scan" -> "robot/laser".
std::string frame_of(const LaserInfo& laser) { return laser.topic.substr(1, laser.topic.rfind('/') - 1); }

}  // namespace

Recorder::Recorder(const std::string& directory, RunInfo info)
    : info_(named(std::move(info))), file_(directory + "/run.mcap"), mcap_("ros2", "sensorfarm") {
  if (count_channels(info_) > kMostChannels) {
    throw base::InputError(file_.path(), 0,
                           "needs " + std::to_string(count_channels(info_)) +
                               " topics, and a file holds 65535: record fewer robots, or no readings");
  }
  mcap_.add_attachment({.name = "world.bin", .media_type = "application/octet-stream", .data = info_.snapshot});
  mcap_.add_metadata({"sensorfarm", summary_of(info_)});
  add_channels();
  write_run_info();
  write_laser_frames();
  flush();
  file_.publish();
  info_.snapshot = {};
}

Recorder::~Recorder() {
  try {
    finish();
  } catch (const base::InputError&) {
    // Every tick whose `write` returned is in the file; only the summary is not.
  }
}

void Recorder::add_channels() {
  const auto schema = [&](std::string_view type) { return mcap_.add_schema(type, "ros2msg", schema_text(type)); };
  info_channel_ = mcap_.add_channel(schema(kRunInfo), "/run", "cdr", kLatched);
  fleet_channel_ = mcap_.add_channel(schema(kFleet), "/fleet", "cdr", kPlain);
  const std::uint16_t transforms = schema(kTransforms);
  transform_channel_ = mcap_.add_channel(transforms, "/tf", "cdr", kPlain);
  static_channel_ = mcap_.add_channel(transforms, "/tf_static", "cdr", kLatched);
  const std::uint16_t odometry = info_.odometry_rate > 0.0 ? schema(kOdometry) : std::uint16_t{0};
  const std::uint16_t twist = info_.odometry_rate > 0.0 ? schema(kTwistStamped) : std::uint16_t{0};
  add_mover_channels(odometry, twist, info_.record_readings ? schema(kLaserScan) : std::uint16_t{0});
}

void Recorder::add_mover_channels(std::uint16_t odometry, std::uint16_t twist, std::uint16_t scan) {
  for (const MoverInfo& mover : info_.movers) {
    MoverChannels& channels = channels_.emplace_back();
    if (odometry != 0) {
      channels.odometry = mcap_.add_channel(odometry, "/" + mover.frame + "/odom", "cdr", kPlain);
      channels.command = mcap_.add_channel(twist, "/" + mover.frame + "/cmd_vel", "cdr", kPlain);
    }
    for (const LaserInfo& laser : mover.lasers) {
      channels.frames.push_back(frame_of(laser));
      if (scan != 0) channels.scans.push_back(mcap_.add_channel(scan, laser.topic, "cdr", kPlain));
    }
  }
}

void Recorder::write_run_info() {
  message_.clear();
  encode_run_info(info_, message_);
  add(info_channel_, 0, 0, 0);
}

void Recorder::write_laser_frames() {
  transforms_.clear();
  for (std::size_t row = 0; row < info_.movers.size(); ++row) {
    const MoverInfo& mover = info_.movers[row];
    for (std::size_t k = 0; k < mover.lasers.size(); ++k) {
      transforms_.push_back({0, mover.frame, channels_[row].frames[k], mover.lasers[k].X_MS});
    }
  }
  message_.clear();
  encode_transforms(transforms_, message_);
  add(static_channel_, 0, 0, 0);
}

void Recorder::write(const base::TickRecord& record) {
  SF_CHECK(!finished_, "tick " + std::to_string(record.tick) + " after the end of the recording");
  for (const base::Report& report : record.reports) {
    SF_CHECK(report.mover < channels_.size(), "mover " + std::to_string(report.mover));
  }
  message_.clear();
  encode_fleet(record, message_);
  add(fleet_channel_, ticks_, record.time, record.time);
  write_transforms(record);
  if (info_.odometry_rate > 0.0 && record.time >= next_odometry_) write_odometry(record);
  for (const base::ReadingBlock& reading : record.readings) {
    if (info_.record_readings) write_reading(reading, record.time);
  }
  flush();
  ++ticks_;
}

void Recorder::write_transforms(const base::TickRecord& record) {
  transforms_.clear();
  for (const base::Report& report : record.reports) {
    transforms_.push_back({record.time, "world", info_.movers[report.mover].frame, report.X_WM});
  }
  message_.clear();
  encode_transforms(transforms_, message_);
  add(transform_channel_, ticks_, record.time, record.time);
}

void Recorder::write_odometry(const base::TickRecord& record) {
  for (std::size_t i = 0; i < record.reports.size(); ++i) {
    const base::Report& report = record.reports[i];
    const std::string& frame = info_.movers[report.mover].frame;
    message_.clear();
    encode_odometry({record.time, "world", frame, report.X_WM}, report.velocity, message_);
    add(channels_[report.mover].odometry, odometries_, record.time, record.time);
    if (record.commands.empty()) continue;
    message_.clear();
    encode_twist(record.time, frame, record.commands[i], message_);
    add(channels_[report.mover].command, odometries_, record.time, record.time);
  }
  ++odometries_;
  const auto period = std::max<std::int64_t>(1, std::llround(1e9 / info_.odometry_rate));
  next_odometry_ = (record.time / period + 1) * period;
}

void Recorder::write_reading(const base::ReadingBlock& reading, std::int64_t time) {
  SF_CHECK(reading.kind == kLaser, "kind " + std::to_string(reading.kind));
  SF_CHECK(reading.mover < channels_.size() && reading.sensor < channels_[reading.mover].scans.size(),
           "mover " + std::to_string(reading.mover) + " sensor " + std::to_string(reading.sensor));
  const LaserInfo& laser = info_.movers[reading.mover].lasers[reading.sensor];
  const MoverChannels& channels = channels_[reading.mover];
  scan_.time = reading.time;
  scan_.frame = channels.frames[reading.sensor];
  scan_.fov = static_cast<float>(laser.fov);
  scan_.scan_time = static_cast<float>(1.0 / laser.rate);
  scan_.range_min = static_cast<float>(laser.range_min);
  scan_.range_max = static_cast<float>(laser.range_max);
  message_.clear();
  encode_scan(scan_, reading.values, message_);
  add(channels.scans[reading.sensor], reading.sequence, time, reading.time);
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
  finished_ = true;  // until the bytes are in the file: after a failure there is nothing to go on with
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
