#pragma once
// Recomputes the laser scans of a recording, without noise, from the recorded poses, tilts and world.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "apps/options/recording_part.h"
#include "base/tilted_pose.h"
#include "farm/farm.h"
#include "scenarios/recorded_states.h"
#include "sensors/laser_modes.h"

namespace sf::apps {

/// True if a chosen mover has a laser.
bool has_laser(const RecordingPart& part, const world::World& world);

/// Returns ticks of a recording at least `seconds` apart, starting with the first.
std::vector<std::size_t> ticks_apart(const RecordingPart& part, double seconds);

/// Returns the poses of all movers at a tick. Movers without a recorded state are absent.
std::vector<base::TiltedPose> poses_at(const RecordingPart& part, std::size_t tick);

class ScanReplay {
 public:
  /// All arguments must outlive it. @param world of the recording; its sensors lose their latency
  ScanReplay(const RecordingPart& part, world::World& world, gpu::Device& device);
  /// Gives the world's movers their shapes at a tick, and returns the scans of all chosen lasers. Ticks may be
  /// requested in any order. Rolling scans repeat the recorded motion before the tick. Times are those of the
  /// recording. Valid until the next call.
  std::span<const base::ReadingBlock> scans_at(std::size_t tick);
  /// Returns the laser of a scan.
  const sensors::SensorSpec& laser(const base::ReadingBlock& scan) const { return farm_.sensor_set().row(scan); }
  /// Returns its pose in the robot's frame.
  base::RigidTransform X_MS(const base::ReadingBlock& scan) const {
    return sensors::laser_mount(farm_.sensor_set(), scan);
  }

 private:
  /// Memory of a scan.
  struct Kept {
    std::vector<double> values;
    std::vector<std::uint32_t> hits;
    std::vector<base::QualityFlag> quality;
  };

  const record::StateSample* state(std::size_t mover, std::ptrdiff_t tick) const;
  void report(std::ptrdiff_t tick);
  void repeat_motion(std::ptrdiff_t tick, std::int64_t now);
  void sense_all();

  const RecordingPart& part_;
  scenarios::RecordedShapes shapes_;
  farm::Farm farm_;
  std::int64_t longest_ = 0;  ///< [ns] rolling scan; 0: no scan rolls
  std::vector<base::Report> reports_;
  std::vector<base::ReadingBlock> scans_;
  std::vector<Kept> kept_;  ///< of `scans_`, if a scan rolls
  std::int64_t calls_ = 0;
};

}  // namespace sf::apps
