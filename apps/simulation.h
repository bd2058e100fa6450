#pragma once
// A simulated fleet in the loop: controllers decide, movers move, the farm senses.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "base/sink.h"
#include "control/controller.h"
#include "farm/farm.h"
#include "robots/fleet.h"
#include "world/world.h"

namespace sf::apps {

/// Every robot wanders, tags stand still, every sensor is heard. `world` and `device` must outlive it.
class Simulation {
 public:
  Simulation(const world::World& world, gpu::Device& device, std::uint64_t seed, unsigned threads);

  /// One tick of `world.interval`; the first looks at time 0, before anything moved. Spans live until the next.
  base::TickRecord step();

  const farm::Farm& farm() const { return farm_; }
  double move_seconds() const { return move_s_; }  ///< spent on controllers and motion

 private:
  void move();
  void sort_by_mover(std::span<const base::ReadingBlock> readings);
  void decide(std::int64_t time);

  const world::World& world_;
  farm::Farm farm_;
  robots::Fleet fleet_;
  base::Workers workers_;
  std::vector<std::unique_ptr<control::Controller>> controllers_;  ///< per mover; none for tags
  std::vector<base::Twist> commands_;
  std::vector<base::Twist> obeyed_;   ///< what the tick just recorded was told to do
  std::vector<std::uint32_t> first_;  ///< per mover: range of its readings in `sorted_`
  std::vector<base::ReadingBlock> sorted_;
  std::int64_t interval_;  ///< [ns]
  std::uint64_t tick_ = 0;
  double move_s_ = 0.0;
};

}  // namespace sf::apps
