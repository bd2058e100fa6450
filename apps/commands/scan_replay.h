#pragma once
// Recomputes the laser scans of a recording, without noise, from the recorded poses and world.

#include <cstdint>
#include <span>
#include <vector>

#include "apps/options/recording_part.h"
#include "farm/farm.h"
#include "scenarios/recorded_states.h"

namespace sf::apps {

/// True if a chosen mover has a laser.
bool has_laser(const RecordingPart& part, const world::World& world);

/// Returns ticks of a recording at least `seconds` apart, starting with the first.
std::vector<std::size_t> ticks_apart(const RecordingPart& part, double seconds);

/// Returns the poses of all movers at a tick. Movers without a recorded state are absent.
std::vector<base::Pose> poses_at(const RecordingPart& part, std::size_t tick);

class ScanReplay {
 public:
  /// All arguments must outlive it. @param world of the recording
  ScanReplay(const RecordingPart& part, world::World& world, gpu::Device& device);
  /// Gives the world's movers their shapes at a tick, and returns the scans of all chosen lasers. Ticks may be
  /// requested in any order. Valid until the next call.
  std::span<const base::ReadingBlock> scans_at(std::size_t tick);
  /// Returns the laser of a scan.
  const sensors::SensorSpec& laser(const base::ReadingBlock& scan) const { return farm_.sensor_set().row(scan); }

 private:
  const RecordingPart& part_;
  scenarios::RecordedShapes shapes_;
  farm::Farm farm_;
  std::vector<base::Report> reports_;
  std::int64_t calls_ = 0;
};

}  // namespace sf::apps
