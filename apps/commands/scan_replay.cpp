#include "apps/commands/scan_replay.h"

#include <algorithm>
#include <cmath>

#include "base/time.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"

namespace sf::apps {

namespace {

/// Time between two replayed ticks. Longer than any scan, and than the periods of most sensors.
constexpr std::int64_t kBetween = 1000 * base::kSecond;

/// Readings are delivered at once, with the tick that they belong to.
world::World& without_latency(world::World& world) {
  for (world::Mover& mover : world.movers)
    for (world::Sensor& sensor : mover.sensors)
      std::erase_if(sensor.settings, [](const world::Setting& setting) { return setting.key == "latency"; });
  return world;
}

}  // namespace

bool has_laser(const RecordingPart& part, const world::World& world) {
  for (std::size_t m = 0; m < part.chosen.size(); ++m)
    if (part.chosen[m] != 0 && sensors::has_laser(world.movers[m])) return true;
  return false;
}

std::vector<std::size_t> ticks_apart(const RecordingPart& part, double seconds) {
  std::size_t count = 0;
  for (const auto& states : part.recording.states) count = std::max(count, states.size());
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(seconds / part.recording.info.interval)));
  std::vector<std::size_t> ticks;
  for (std::size_t tick = 0; tick < count; tick += step) ticks.push_back(tick);
  return ticks;
}

std::vector<base::TiltedPose> poses_at(const RecordingPart& part, std::size_t tick) {
  std::vector<base::TiltedPose> poses;
  for (const auto& states : part.recording.states) {
    poses.push_back({base::kAbsent, {}});
    if (tick < states.size()) poses.back() = {states[tick].X_WM, states[tick].tilt};
  }
  return poses;
}

ScanReplay::ScanReplay(const RecordingPart& part, world::World& world, gpu::Device& device)
    : part_(part), shapes_(part.recording, world), farm_(without_latency(world), device, [] {
        farm::FarmOptions quiet;
        quiet.noise = false;
        return quiet;
      }()) {
  const auto* const lasers = farm_.sensor_set().group(sensors::kLaser);
  for (std::size_t i = 0; lasers != nullptr && i < lasers->rows.size(); ++i)
    longest_ = std::max(longest_, base::nanoseconds(lasers->rows[i].sweep));
}

const record::StateSample* ScanReplay::state(std::size_t mover, std::ptrdiff_t tick) const {
  const auto& earlier = part_.before[mover];
  const auto& states = part_.recording.states[mover];
  const std::ptrdiff_t row = std::ssize(earlier) + tick;
  if (row < 0 || tick >= std::ssize(states)) return nullptr;
  return tick < 0 ? &earlier[static_cast<std::size_t>(row)] : &states[static_cast<std::size_t>(tick)];
}

void ScanReplay::report(std::ptrdiff_t tick) {
  reports_.clear();
  for (std::uint32_t m = 0; m < part_.recording.states.size(); ++m) {
    const record::StateSample* const known = state(m, tick);
    farm_.set_absent(m, known == nullptr || base::is_absent(known->X_WM));
    if (known != nullptr) reports_.push_back(record::report_of(*known, m));
  }
}

/// Repeats the motion during a scan at `tick`, which has the time `now` in the farm.
void ScanReplay::repeat_motion(std::ptrdiff_t tick, std::int64_t now) {
  for (std::uint32_t m = 0; m < part_.recording.states.size(); ++m) farm_.set_absent(m, true);
  farm_.tick(now - kBetween + 1, {});  // forgets the scan before
  const auto since = [&](std::ptrdiff_t earlier) { return state(0, tick)->time - state(0, earlier)->time; };
  std::ptrdiff_t first = tick;
  while (since(first) < longest_ && state(0, first - 1) != nullptr && since(first - 1) < kBetween - 1) --first;
  for (; first < tick; ++first) {
    report(first);
    farm_.tick(now - since(first), reports_);
  }
}

std::span<const base::ReadingBlock> ScanReplay::scans_at(std::size_t tick) {
  const auto row = static_cast<std::ptrdiff_t>(tick);
  const record::StateSample* const first = state(0, row);
  if (first != nullptr) shapes_.go_to(first->time);
  if (!shapes_.changed().empty()) farm_.update_outlines();
  const std::int64_t now = ++calls_ * kBetween;
  if (longest_ > 0 && first != nullptr) repeat_motion(row, now);
  report(row);
  for (const base::Report& each : reports_)
    if (part_.chosen[each.mover] != 0 && longest_ == 0) farm_.subscribe(each.mover, base::only(sensors::kLaser));
  const std::span<const base::ReadingBlock> scans = farm_.tick(now, reports_);
  scans_.assign(scans.begin(), scans.end());
  if (longest_ > 0) sense_all();
  for (base::ReadingBlock& scan : scans_) scan.time = reports_.front().time;
  return scans_;
}

/// Rolling lasers are not due again right after the motion.
void ScanReplay::sense_all() {
  kept_.clear();
  for (const base::Report& each : reports_) {
    const std::size_t lasers = part_.chosen[each.mover] == 0 || base::is_absent(each.X_WM)
                                   ? 0
                                   : farm_.sensor_set().of(sensors::kLaser, each.mover).size();
    for (std::uint32_t i = 0; i < lasers; ++i) {
      const base::ReadingBlock scan = farm_.sense(each.mover, sensors::kLaser, i, each.X_WM, each.tilt);
      scans_.push_back(scan);
      kept_.push_back({{scan.values.begin(), scan.values.end()},
                       {scan.hits.begin(), scan.hits.end()},
                       {scan.quality.begin(), scan.quality.end()}});
    }
  }
  for (std::size_t i = 0; i < kept_.size(); ++i)
    scans_[i].values = kept_[i].values, scans_[i].hits = kept_[i].hits, scans_[i].quality = kept_[i].quality;
}

}  // namespace sf::apps
