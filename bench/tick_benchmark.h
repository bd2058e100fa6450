#pragma once
// Whole ticks: a simulated fleet with bodies, moved, sensed and decided for.

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
  std::vector<Cost> ticks;  ///< whole ticks: move, sense, decide
  Cost typical;             ///< medians of `ticks`
  double move_s = 0.0;      ///< [s] mean per tick, as are all below
  double decide_s = 0.0;
  farm::FarmStats stages;  ///< of the measured ticks together
  AccuracyCheck accuracy;
  std::uint64_t hash = 0;  ///< of the last tick's ranges
};

/// A world with robots at work. `world` and `device` must outlive it.
class TickBenchmark {
 public:
  TickBenchmark(const world::World& world, gpu::Device& device);

  /// One tick. Robots wander when `wander`, else stand where they are.
  void tick(bool wander);
  double move_s() const { return move_s_; }  ///< [s] so far
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

/// Drives `ticks` ticks after `warm_up` unmeasured ones.
TickResult run_ticks(const std::string& scene, const world::World& world, gpu::Device& device, bool wander,
                     std::size_t warm_up, std::size_t ticks);

}  // namespace sf::bench
