#pragma once
// Laser scans of a recording, computed again from the recorded poses and world, without noise.

#include <cstdint>
#include <span>
#include <vector>

#include "apps/options/recording_part.h"
#include "farm/farm.h"

namespace sf::apps {

/// True when a chosen mover has a laser.
bool has_laser(const RecordingPart& part, const world::World& world);

/// Ticks of a recording at least `seconds` apart, the first one among them.
std::vector<std::size_t> ticks_apart(const RecordingPart& part, double seconds);

/// Poses of all movers at a tick of the recording. Those of which it says nothing are absent.
std::vector<base::Pose> poses_at(const RecordingPart& part, std::size_t tick);

class ScanReplay {
 public:
  /// All references must live as long as this.
  ScanReplay(const RecordingPart& part, const world::World& world, gpu::Device& device);
  /// Scans of all chosen lasers at a tick of the recording, in any order of ticks. Valid until the next call.
  std::span<const base::ReadingBlock> scans_at(std::size_t tick);

 private:
  const RecordingPart& part_;
  farm::Farm farm_;
  std::vector<base::Report> reports_;
  std::int64_t calls_ = 0;
};

}  // namespace sf::apps
