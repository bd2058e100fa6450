#pragma once
// Strategies by which processes share the fleet of a simulation: one process simulates it alone, or ranks share it by
// robot or by tile. A simulation calls its share at fixed points of a step, independent of the strategy.

#include <cstdint>
#include <exception>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/report.h"
#include "base/state_quality.h"
#include "cluster/ranks.h"
#include "farm/farm.h"
#include "robots/fleet.h"
#include "world/world.h"

namespace sf::scenarios {

/// State of a robot's controller, shared with all ranks.
struct ControlStatus {
  bool drives = false;   ///< the robot has a controller
  bool stepped = false;  ///< in the last tick
  bool done = false;
  double error = std::numeric_limits<double>::quiet_NaN();  ///< see control::Controller
};

/// A robot's estimate of its own state, which it broadcasts.
struct OwnEstimate {
  base::Report state;
  base::StateQuality quality;  ///< not stated: it has no estimate, and broadcasts its true state
};

/// Decisions of one step, one row per mover. `FleetShare::finish_step` fills in those of other processes.
struct FleetStep {
  std::span<base::Twist> commands;
  std::span<base::Intent> intents;
  std::span<OwnEstimate> estimates;
};

/// Outcome of this process's part of a step.
struct OwnOutcome {
  std::function<ControlStatus(std::uint32_t mover)> status;  ///< of an own mover
  std::uint32_t failed = world::kNone;                       ///< first mover whose controller threw `failure`
  std::exception_ptr failure;                                ///< null: no failure
};

/// The base class is the share of a process that simulates the whole fleet alone. Not thread-safe; all ranks make the
/// same calls.
class FleetShare {
 public:
  virtual ~FleetShare() = default;

  /// Returns the part of the world that this process needs.
  /// @param whole as loaded; outlives the share
  virtual const world::World& part_of(const world::World& whole) const { return whole; }
  /// Returns whether this process decides for the mover and delivers its readings.
  virtual bool owns(std::uint32_t) const { return true; }
  /// @throws base::InputError if robots can neither join nor leave
  virtual void check_may_join() const {}
  /// @throws base::InputError if maps of robots (control/shared_map.h) do not reach all processes
  virtual void check_may_share_maps() const {}
  virtual void add_mover() {}                                      ///< adds the mover that joined in the last row
  virtual void remove_last() {}                                    ///< undoes `add_mover`
  virtual void set_status(std::uint32_t, const ControlStatus&) {}  ///< of a mover that joins, returns or leaves
  /// Returns the status agreed on after `finish_step`; null if this process has all controllers.
  virtual const ControlStatus* status(std::uint32_t) const { return nullptr; }

  /// Called once, before the robots get their controllers. `world` is `part_of` the whole.
  virtual void attach(const world::World& /*world*/, farm::Farm&) {}
  /// Called once, before the first step. `fleet` must outlive the share.
  /// @param v2v_ranges [m] per mover; in: of own movers, 0 for others; out: of all movers that matter here
  virtual void begin(robots::Fleet& /*fleet*/, std::span<double> /*v2v_ranges*/) {}
  virtual void begin_step(std::uint64_t /*tick*/) {}
  /// @param radio whether a robot may receive states of others by radio
  virtual void after_motion(bool /*radio*/) {}
  /// Starts the exchange of decisions.
  /// @throws the failure, if no other process needs to receive it first
  virtual void end_step(const FleetStep&, const OwnOutcome& own) {
    if (own.failure) std::rethrow_exception(own.failure);
  }
  /// Completes the exchange, after which `step` has the decisions for all movers.
  /// @throws cluster::Failure on all ranks, with the first mover's error
  virtual void finish_step(const FleetStep&) {}

  /// Returns the states of the robots in radio range of a mover that another process moves; nullopt if this process
  /// moves it.
  virtual std::optional<std::span<const base::Report>> remote_neighbours(std::uint32_t) const { return std::nullopt; }
  /// Returns whether this process has the mover's pose.
  virtual bool knows(std::uint32_t) const { return true; }

  /// Requests that all processes stop after the same step; `stop_agreed` then returns true.
  virtual void request_stop() {}
  virtual bool stop_agreed() const { return false; }
  /// Returns the number of movers that this process has handed over to others; nullopt if movers are never handed over.
  virtual std::optional<std::uint64_t> passed_on() const { return std::nullopt; }
  /// Returns warnings about robots that start inside walls, if loading could not check that. Called before the first
  /// step.
  virtual std::vector<world::Warning> warnings_of_starts() { return {}; }
};

struct ShareOptions {
  cluster::Ranks* ranks = nullptr;  ///< null: one process
  bool tiles = false;               ///< each rank moves and senses the robots in one part of the world; requires ranks
  double balance = 0.0;             ///< [s] simulated time between repartitions of the tiles; 0: fixed tiles
};

std::unique_ptr<FleetShare> make_fleet_share(const world::World& world, const ShareOptions& options);

}  // namespace sf::scenarios
