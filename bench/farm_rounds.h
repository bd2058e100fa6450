#pragma once
// Runs the farm in a comparison: rounds of poses, one tick each, with results that can be poisoned in between.

#include <cstdint>
#include <span>
#include <vector>

#include "base/report.h"
#include "bench/poison.h"
#include "farm/farm.h"

namespace sf::bench {

class FarmRounds {
 public:
  /// Subscribes all sensors. @param rounds poses, one per mover @param interval [ns] of simulated time between ticks
  FarmRounds(const world::World& world, gpu::Device& device, const std::vector<std::vector<base::Pose>>& rounds,
             std::int64_t interval)
      : farm_(world, device, {.reuse_unchanged = false}), interval_(interval) {
    farm_.subscribe_all();
    for (const std::vector<base::Pose>& poses : rounds) {
      std::vector<base::Report>& reports = reports_.emplace_back();
      for (std::uint32_t m = 0; m < poses.size(); ++m) reports.push_back({m, 0, poses[m], {}});
    }
  }

  void tick(std::size_t round) {
    readings_ = farm_.tick(time_, reports_[round]);
    time_ += interval_;
  }
  void poison() { bench::poison(readings_); }

  /// Returns the readings of the last tick.
  std::span<const base::ReadingBlock> readings() const { return readings_; }
  const farm::Farm& farm() const { return farm_; }

 private:
  farm::Farm farm_;
  std::vector<std::vector<base::Report>> reports_;
  std::span<const base::ReadingBlock> readings_;
  std::int64_t interval_;  ///< [ns]
  std::int64_t time_ = 0;  ///< [ns]
};

}  // namespace sf::bench
