#pragma once
// A simulated fleet in the loop: controllers decide, movers move, the farm senses.
//
//   Simulation simulation(world, device, {.seed = 7, .plan = {.controller = "wander"}});
//   while (running) recorder.write(simulation.step());
//
// One tick: motion since the last one, readings, decisions. What is decided at a tick is driven until the next. Sensors
// look at their own times, between ticks too.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/sink.h"
#include "base/thread_pool.h"
#include "control/controllers.h"
#include "farm/farm.h"
#include "farm/stored_reading.h"
#include "netio/link_model.h"
#include "robots/fleet.h"
#include "robots/neighbour_grid.h"
#include "scenarios/mailbox.h"
#include "world/lights.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::scenarios {

/// Who drives one robot, and how its readings come to it.
struct Actor {
  control::ControllerConfig plan{.controller = "wander"};  ///< no name: the robot stands
  netio::LinkModel link;                                   ///< of its readings; V2V and its own state are not delayed
};

struct SimulationOptions {
  std::uint64_t seed = 1;      ///< of noise and of controllers' choices
  unsigned threads = 0;        ///< of the host's part; 0: all. Never changes a result
  Actor actor;                 ///< of every robot
  std::vector<Actor> actors;   ///< of each mover by row, tags too, where not empty; else tags stand
  double start_at = 0.0;       ///< [s] the start signal is given from here on
  bool no_return_inf = false;  ///< see farm::FarmOptions
};

/// `world` and `device` must outlive it. One thread at a time. Nothing is allocated by a tick after warm-up.
class Simulation {
 public:
  /// @throws base::InputError for a controller that does not exist, cannot have its settings or lacks what it needs.
  Simulation(const world::World& world, gpu::Device& device, SimulationOptions options);

  /// One tick of `world.interval`; the first looks at time 0, before anything moved. Its readings are those since the
  /// last one, by the time of their delivery. Spans live until the next.
  base::TickRecord step();

  /// Takes the mover by hand and puts it there, at rest. Between two steps.
  void put(std::uint32_t mover, const base::Pose& X_WM);

  const farm::Farm& farm() const { return farm_; }
  double move_seconds() const { return move_s_; }  ///< [s] spent on controllers and motion

  /// Of one mover; null for those that stand.
  const control::Controller* controller(std::uint32_t mover) const { return drivers_[mover].controller.get(); }
  /// The last tick asked it what to do.
  bool stepped(std::uint32_t mover) const { return drivers_[mover].stepped; }
  /// All controllers are done; false where there are none.
  bool all_done() const;
  const world::RoadNetwork* roads() const { return roads_ ? &*roads_ : nullptr; }
  /// Warnings of the first files that a controller has read (a mission).
  const std::vector<world::Warning>& warnings() const { return warnings_; }

 private:
  struct Driver {
    std::unique_ptr<control::Controller> controller;  ///< none: stands
    double rate = 10.0;                               ///< [Hz]
    bool by_lasers = false;                           ///< steps when a scan comes or its bumper speaks, not by rate
    bool stepped = false;
    std::uint64_t begun = 0;         ///< steps so far, by rate
    std::optional<Mailbox> mailbox;  ///< none: readings are looked at as they come
  };
  Driver make_driver(std::uint32_t mover, const SimulationOptions& options);
  void move();
  std::span<const base::ReadingBlock> sense(std::int64_t time);
  void sort_by_mover(std::span<const base::ReadingBlock> readings);
  void decide(std::int64_t time);
  void decide_one(std::uint32_t mover, std::int64_t time, unsigned thread);
  std::int64_t leaves_at(const base::ReadingBlock& reading) const;
  bool due(Driver& driver, std::span<const base::ReadingBlock> fresh, std::int64_t time, bool contact) const;
  void find_others(std::uint32_t mover, double v2v_range, std::vector<control::Neighbour>& others) const;

  const world::World& world_;
  std::optional<world::RoadNetwork> roads_;
  base::ThreadPool thread_pool_;
  farm::Farm farm_;
  robots::Fleet fleet_;
  robots::NeighbourGrid neighbours_;
  std::vector<Driver> drivers_;  ///< per mover
  std::vector<base::Twist> commands_;
  std::vector<base::Twist> executed_commands_;    ///< what the tick just recorded was told to do
  std::span<const base::ReadingBlock> by_mover_;  ///< of this tick: those given, where they are in order, or `sorted_`
  std::vector<std::uint32_t> first_;              ///< per mover, and the end: its first of them
  std::vector<std::uint32_t> next_;               ///< scratch
  std::vector<base::ReadingBlock> sorted_;
  std::vector<base::Report> before_;          ///< at the last tick, where a sensor is due before the next; else empty
  std::vector<base::Report> on_the_way_;      ///< between them
  std::vector<farm::StoredReading> early_;    ///< readings from between them: places are reused, with their memory
  std::vector<base::ReadingBlock> readings_;  ///< these, and the tick's; empty where there are none of these
  std::vector<base::Intent> intents_;         ///< per mover, as others hear them now
  std::vector<base::Intent> next_intents_;    ///< as they will from the next tick on
  std::vector<std::vector<control::Neighbour>> others_;  ///< per thread
  std::vector<world::Signal> signals_;
  std::vector<world::Warning> warnings_;
  double v2v_range_ = 0.0;  ///< [m] farthest that anyone wants to hear
  std::int64_t start_at_;
  std::int64_t interval_;  ///< [ns]
  std::uint64_t tick_ = 0;
  double move_s_ = 0.0;
};

}  // namespace sf::scenarios
