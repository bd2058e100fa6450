#include "apps/commands/scan_replay.h"

#include <algorithm>
#include <cmath>

#include "base/time.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"

namespace sf::apps {

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

std::vector<base::Pose> poses_at(const RecordingPart& part, std::size_t tick) {
  std::vector<base::Pose> poses;
  for (const auto& states : part.recording.states)
    poses.push_back(tick < states.size() ? states[tick].X_WM : base::kAbsent);
  return poses;
}

ScanReplay::ScanReplay(const RecordingPart& part, world::World& world, gpu::Device& device)
    : part_(part), shapes_(part.recording, world), farm_(world, device, [] {
        farm::FarmOptions quiet;
        quiet.noise = false;
        return quiet;
      }()) {}

std::span<const base::ReadingBlock> ScanReplay::scans_at(std::size_t tick) {
  reports_.clear();
  const auto& first = part_.recording.states.front();
  if (tick < first.size()) shapes_.go_to(first[tick].time);
  if (!shapes_.changed().empty()) farm_.update_outlines();
  for (std::uint32_t m = 0; m < part_.recording.states.size(); ++m) {
    const auto& states = part_.recording.states[m];
    const bool known = tick < states.size();
    farm_.set_absent(m, !known || base::is_absent(states[tick].X_WM));
    if (!known) continue;
    if (part_.chosen[m] != 0) farm_.subscribe(m, base::only(sensors::kLaser));
    reports_.push_back({m, states[tick].time, states[tick].X_WM, states[tick].velocity});
  }
  // Advances by a long time in each call, so that sensors with long periods are due, too.
  return farm_.tick(++calls_ * 1000 * base::kSecond, reports_);
}

}  // namespace sf::apps
