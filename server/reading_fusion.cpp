#include "server/reading_fusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "sensors/bumper.h"
#include "sensors/infrared.h"

namespace sf::server {

using estimation::ClockSource;
using estimation::ClockVerdict;

namespace {

bool is_bumper(std::uint8_t type) { return type == sensors::kBumper; }
bool is_known(double value) { return !std::isnan(value); }

}  // namespace

ReadingFusion::ReadingFusion(const world::World& world, const sensors::SensorSet& sensor_set,
                             const FusionOptions& options)
    : world_(world), sensor_set_(sensor_set), options_(options), walls_(world) {}

std::string ReadingFusion::refusal_of(const netio::Header& header, const netio::OwnReadings& own,
                                      std::uint32_t mover) const {
  const sensors::SensorType& type = *sensors::find_sensor_type(own.type);
  const auto rows = sensor_set_.of(own.type, mover);
  if (header.sensor >= rows.size())
    return fmt::format("the world file gives it {} of this type", rows.empty() ? "no sensor" : "fewer sensors");
  const sensors::SensorSpec& row = rows[header.sensor];
  if (own.total != row.elements)
    return fmt::format("they have {} values, and those of '{}' in the world file {}", own.total, row.name,
                       row.elements);
  const double fov = netio::kOwnFovUnit * own.fov;
  if (type.is_scan && row.elements > 1 && std::abs(fov - row.fov) > kFovTolerance)
    return fmt::format("their field of view is {:.3f} rad, and that of '{}' in the world file {:.3f} rad", fov,
                       row.name, row.fov);
  return "";
}

void ReadingFusion::take(const netio::Header& header, const netio::OwnReadings& own, std::uint32_t mover,
                         std::int64_t now, netio::RateLimitedLog& log) {
  const std::string refusal = refusal_of(header, own, mover);
  std::string& refused = refusals_[{mover, own.type, std::min<std::uint32_t>(header.sensor, kMostRefused)}];
  const bool again = std::exchange(refused, refusal) == refusal;
  if (!refusal.empty()) {
    ++counts_.unfit;
    if (again) return;
    return log.write(
        fmt::format("OWN_READINGS of {} {} of {} (id {}) are dropped: {}", sensors::find_sensor_type(own.type)->name,
                    header.sensor, world_.movers[mover].name, header.robot, refusal),
        now);
  }
  Sensor& sensor = sensors_[{mover, own.type, header.sensor}];
  Whole& arriving = sensor.arriving;
  if (own.first == 0 && !begin(header, sensor, mover, now)) return;
  if (arriving.time != header.time || arriving.elements != own.first) {
    if (arriving.time != header.time || arriving.elements != SIZE_MAX) ++counts_.incomplete;
    arriving = {header.time, SIZE_MAX, std::move(arriving.values)};
    return;
  }
  arriving.values.resize(own.total);
  for (std::size_t k = 0; k < own.count; ++k) arriving.values[own.first + k] = netio::value_of(own, k);
  arriving.elements += own.count;
  if (arriving.elements < own.total) return;
  if (options_.clock.source == ClockSource::arrival) arriving.time = now;
  std::swap(sensor.newest, arriving);
  sensor.mapped = false;
  arriving.elements = 0;
  ++counts_.taken;
}

/// Returns the farm's time in the unit of `SenderClock`.
std::int64_t ReadingFusion::arrival(std::int64_t now) const {
  return options_.clock.source == ClockSource::trusted ? now + options_.epoch : now;
}

/// Begins a reading with its first part. @return whether it is used
bool ReadingFusion::begin(const netio::Header& header, Sensor& sensor, std::uint32_t mover, std::int64_t now) {
  if (sensor.arriving.elements > 0 && sensor.arriving.elements != SIZE_MAX) ++counts_.incomplete;
  sensor.arriving = {header.time, SIZE_MAX, std::move(sensor.arriving.values)};
  Sender& sender =
      senders_.try_emplace(mover, Sender{header.session, estimation::SenderClock(options_.clock)}).first->second;
  if (std::exchange(sender.session, header.session) != header.session) {
    sender.clock.reset();
    forget(mover);
  }
  const ClockVerdict verdict = sender.clock.take(header.time, arrival(now));
  if (verdict == ClockVerdict::stepped) forget(mover);
  if (verdict == ClockVerdict::future || verdict == ClockVerdict::late) return ++counts_.mistimed, false;
  const bool by_arrival = options_.clock.source == ClockSource::arrival;
  if (!by_arrival && sensor.newest.elements > 0 && header.time <= sensor.newest.time) return ++counts_.overtaken, false;
  sensor.arriving.elements = 0;
  return true;
}

/// Times before a restart of the sender, or a reset of its clock, are not comparable.
void ReadingFusion::forget(std::uint32_t mover) {
  for (auto& [key, sensor] : sensors_)
    if (key[0] == mover) sensor.newest.elements = 0;
}

void ReadingFusion::fuse(std::span<base::ReadingBlock> readings) {
  if (senders_.empty()) return;
  for (base::ReadingBlock& reading : readings) {
    const auto found = sensors_.find({reading.mover, reading.type, reading.sensor});
    if (found != sensors_.end() && found->second.newest.elements > 0) {
      fuse_own(reading, found->second);
    } else if (reading.type == netio::kOwnLaser && !walls_.empty() && !senders_.contains(reading.mover)) {
      fuse_walls(reading);
    }
  }
}

void ReadingFusion::fuse_own(base::ReadingBlock& reading, Sensor& sensor) {
  const std::int64_t time = senders_.at(reading.mover).clock.to_sender(arrival(reading.time));
  const std::int64_t age = time - sensor.newest.time;
  if (std::abs(age) > options_.max_age) {
    ++counts_.too_old;
    return;
  }
  if (!fuse(reading, sensor, sensor.newest.values)) return;
  const double seconds = std::max(0.0, 1e-9 * static_cast<double>(age));
  ++counts_.fused;
  counts_.age_s += seconds;
  counts_.oldest_s = std::max(counts_.oldest_s, seconds);
  if (reading.type == netio::kOwnLaser) map(reading, age, sensor);
}

/// Adds a scan at the pose of its own time, between the last two virtual readings. Others would show walls elsewhere
/// where the robot turns.
void ReadingFusion::map(const base::ReadingBlock& reading, std::int64_t age, Sensor& sensor) {
  const base::Pose before = std::exchange(sensor.X_WS, reading.X_WS);
  const std::int64_t from = std::exchange(sensor.at, reading.time), span = reading.time - from;
  if (std::exchange(sensor.mapped, true) || from < 0 || span <= 0 || span > options_.max_age || age > span) return;
  const double share = std::clamp(static_cast<double>(age) / static_cast<double>(span), 0.0, 1.0);
  base::Pose X_WS = reading.X_WS;
  X_WS.x += share * (before.x - X_WS.x);
  X_WS.y += share * (before.y - X_WS.y);
  X_WS.yaw += share * base::wrap_angle(before.yaw - X_WS.yaw);
  walls_.add(sensor_set_.row(reading), X_WS, sensor.newest.values);
}

void ReadingFusion::fuse_walls(base::ReadingBlock& reading) {
  const sensors::SensorSpec& row = sensor_set_.row(reading);
  seen_.assign(reading.values.size(), std::nan(""));
  for (std::uint32_t i = 0; i < seen_.size(); ++i) {
    const double range = walls_.cast(reading.X_WS, sensors::bearing_of(row, i), reading.values[i]);
    if (range < reading.values[i]) seen_[i] = range;
  }
  if (fuse(reading, sensors_[{reading.mover, reading.type, reading.sensor}], seen_)) ++counts_.mapped;
}

/// @return false if no value of `own` is known
bool ReadingFusion::fuse(base::ReadingBlock& reading, Sensor& sensor, std::span<const double> own) const {
  if (std::none_of(own.begin(), own.end(), is_known)) return false;
  sensor.values.assign(reading.values.begin(), reading.values.end());
  sensor.hits.assign(reading.hits.begin(), reading.hits.end());
  sensor.quality.assign(reading.quality.begin(), reading.quality.end());
  if (is_bumper(reading.type)) {
    for (std::size_t i = 0; i < sensor.values.size(); ++i) sensor.values[i] = std::max(sensor.values[i], own[i]);
  } else {
    fuse_ranges(reading, sensor, own);
  }
  reading.values = sensor.values;
  reading.hits = sensor.hits;
  reading.quality = sensor.quality;
  reading.fused = true;
  return true;
}

/// An own range beyond the virtual sensor's limit is no echo, and one below its minimum is too near.
void ReadingFusion::fuse_ranges(base::ReadingBlock& reading, Sensor& sensor, std::span<const double> own) const {
  const sensors::SensorSpec& row = sensor_set_.row(reading);
  const base::RangeLimits limits = sensors::limits_of(row);
  const std::size_t width = sensor.values.size() / own.size();
  for (std::size_t i = 0; i < own.size(); ++i) {
    const double nearer = own[i];
    double& range = sensor.values[width * i];
    if (!(nearer < range) || base::echo_of(nearer, limits) == base::Echo::none) continue;
    const bool too_near = base::echo_of(nearer, limits) == base::Echo::too_near;
    if (too_near && sensor.quality.empty()) sensor.quality.assign(own.size(), base::QualityFlag::none);
    range = std::max(nearer, limits.min);
    if (reading.type == sensors::kInfrared) sensor.values[width * i + 1] = sensors::infrared_response(range, limits);
    if (!sensor.hits.empty()) sensor.hits[i] = base::kNoHit;
    if (!sensor.quality.empty()) sensor.quality[i] = too_near ? base::QualityFlag::too_near : base::QualityFlag::none;
  }
  reading.bound = reading.bound_without_noise = reading.sigma = HUGE_VAL;
}

}  // namespace sf::server
