#pragma once
// Complete ticks of a simulated fleet with bodies: motion, sensors, decisions.

#include <memory>
#include <string>
#include <vector>

#include "base/reading.h"
#include "base/thread_pool.h"
#include "bench/accuracy_check.h"
#include "bench/cost.h"
#include "control/controller.h"
#include "farm/farm.h"
#include "robots/fleet.h"

namespace sf::bench {

struct TickResult {
  std::string scene;
  std::string what;
  std::size_t robots = 0;
  std::size_t rays = 0;  ///< per tick
  double range_m = 0.0;
  double interval_s = 0.0;  ///< [s] simulated time per tick
  std::vector<Cost> ticks;  ///< whole ticks: motion, sensors, decisions
  Cost typical;             ///< medians of `ticks`
  double move_s = 0.0;      ///< [s] mean per tick, like the times below
  double decide_s = 0.0;
  farm::FarmStats stages;  ///< sums over the measured ticks
  AccuracyCheck accuracy;
  std::uint64_t hash = 0;  ///< of the last tick's ranges
};

/// A world with driving robots. `world` and `device` must outlive it.
class TickBenchmark {
 public:
  TickBenchmark(const world::World& world, gpu::Device& device);

  /// Runs one tick. @param wander false: robots do not move
  void tick(bool wander);
  double move_s() const { return move_s_; }  ///< [s] total
  double decide_s() const { return decide_s_; }
  farm::Farm& farm() { return farm_; }
  std::span<const base::ReadingBlock> readings() const { return readings_; }
  std::vector<base::Pose> poses() const;
  std::int64_t interval() const { return interval_; }  ///< [ns]

 private:
  void decide();

  const world::World& world_;
  base::ThreadPool thread_pool_;
  farm::Farm farm_;
  robots::Fleet fleet_;
  std::vector<std::unique_ptr<control::Controller>> controllers_;  ///< one per mover
  std::vector<base::Twist> commands_;
  std::span<const base::ReadingBlock> readings_;
  std::int64_t time_ = 0;      ///< [ns]
  std::int64_t interval_ = 0;  ///< [ns] of the first laser
  double move_s_ = 0.0;
  double decide_s_ = 0.0;
};

/// Runs `ticks` measured ticks after `warm_up` unmeasured ones.
TickResult run_ticks(const std::string& scene, const world::World& world, gpu::Device& device, bool wander,
                     std::size_t warm_up, std::size_t ticks);

}  // namespace sf::bench
