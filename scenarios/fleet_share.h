#pragma once
// How processes share the fleet of a simulation: one simulates all of it, ranks share it robot by robot, or tile by
// tile. A simulation calls its share at fixed points of a step and does not know which one it is.

#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/report.h"
#include "cluster/ranks.h"
#include "farm/farm.h"
#include "robots/fleet.h"
#include "world/world.h"

namespace sf::scenarios {

/// State of a robot's controller, as all ranks know it.
struct ControlStatus {
  bool drives = false;   ///< the robot has a controller
  bool stepped = false;  ///< in the last tick
  bool done = false;
  double error = std::numeric_limits<double>::quiet_NaN();  ///< see control::Controller
};

/// Decisions of one step. One row per mover; those of other processes are filled in by `FleetShare::finish_step`.
struct FleetStep {
  std::span<base::Twist> commands;
  std::span<base::Intent> intents;
};

/// Outcome of this process' part of a step.
struct OwnOutcome {
  std::function<ControlStatus(std::uint32_t mover)> status;  ///< of an own mover
  std::uint32_t failed = world::kNone;                       ///< first mover whose controller threw `failure`
  std::exception_ptr failure;                                ///< null: none did
};

/// The base class is the share of a process that simulates the whole fleet alone. One thread; ranks make the same
/// calls.
class FleetShare {
 public:
  virtual ~FleetShare() = default;

  /// The part of the world that this process needs. @param whole as loaded; outlives the share
  virtual const world::World& part_of(const world::World& whole) const { return whole; }
  /// This process decides for the mover and delivers its readings.
  virtual bool owns(std::uint32_t) const { return true; }
  /// @throws base::InputError where robots can neither join nor leave
  virtual void check_may_join() const {}
  virtual void add_mover() {}                                      ///< a mover joins, in the last row
  virtual void remove_last() {}                                    ///< takes that back
  virtual void set_status(std::uint32_t, const ControlStatus&) {}  ///< of a mover that joins, returns or leaves
  /// The status that all processes agreed on after `finish_step`; null: this process knows all controllers.
  virtual const ControlStatus* status(std::uint32_t) const { return nullptr; }

  /// Once, before the robots get their controllers. `world` is `part_of` the whole.
  virtual void attach(const world::World& /*world*/, farm::Farm&) {}
  /// Once, before the first step. `fleet` must outlive the share.
  /// @param v2v_ranges [m] per mover; in: of own movers, 0 for others; out: of all movers that matter here
  virtual void begin(robots::Fleet& /*fleet*/, std::span<double> /*v2v_ranges*/) {}
  virtual void begin_step(std::uint64_t /*tick*/) {}
  /// @param radio a robot may receive states of others by radio
  virtual void after_motion(bool /*radio*/) {}
  /// Starts the exchange of decisions. @throws the failure, where no other process must learn of it first
  virtual void end_step(const FleetStep&, const OwnOutcome& own) {
    if (own.failure) std::rethrow_exception(own.failure);
  }
  /// Completes the exchange: `step` has the decisions of all. @throws cluster::Failure on all ranks, with the first
  /// mover's error
  virtual void finish_step(const FleetStep&) {}

  /// States of the robots in radio range of a mover that another process moves; nullopt: this process moves it.
  virtual std::optional<std::span<const base::Report>> remote_neighbours(std::uint32_t) const { return std::nullopt; }
  /// This process knows where the mover is.
  virtual bool knows(std::uint32_t) const { return true; }

  /// All processes are to stop after one and the same step; `stop_agreed` then returns true.
  virtual void request_stop() {}
  virtual bool stop_agreed() const { return false; }
  /// Movers that this process has passed on to others so far; nullopt: movers stay where they are.
  virtual std::optional<std::uint64_t> passed_on() const { return std::nullopt; }
  /// Robots that start inside walls, where loading could not find them; before the first step.
  virtual std::vector<world::Warning> warnings_of_starts() { return {}; }
};

struct ShareOptions {
  cluster::Ranks* ranks = nullptr;  ///< null: one process
  bool tiles = false;               ///< each rank moves and senses the robots in a part of the world; needs ranks
  double balance = 0.0;             ///< [s] simulated between new cuts of the tiles; 0: tiles stay
};

std::unique_ptr<FleetShare> make_fleet_share(const world::World& world, const ShareOptions& options);

}  // namespace sf::scenarios
