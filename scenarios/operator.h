#pragma once
// Applies requests of bridge users to a simulated run: pause, single ticks, speed, reset, and driving and placing
// robots.

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "bridges/bridge.h"
#include "scenarios/simulation.h"

namespace sf::scenarios {

class Operator {
 public:
  /// @param speed [1] simulated over real time, > 0; infinity: as fast as possible @param stop ends all waiting; must
  /// outlive the operator, as must the bridges
  Operator(bridges::Bridges& bridges, const std::atomic<bool>& stop, double speed);

  static constexpr std::size_t kMostJoining = 4;  ///< robots per tick, because each takes time; others wait
  /// Changes the fleet between two ticks and writes the outcomes.
  using ChangeFleet =
      std::function<void(const std::vector<bridges::Joining>& joining, const std::vector<bridges::Leaving>& leaving)>;
  /// Sets the handler of fleet changes. Without a handler, such requests are refused.
  void on_fleet_changes(ChangeFleet change) { change_fleet_ = std::move(change); }
  /// Sets whether `wait` may return `Next::world`; otherwise such requests are refused.
  void set_loads_worlds(bool loads) { loads_worlds_ = loads; }

  enum class Next { tick, reset, world, stop };
  /// Applies user requests, and waits until the run's next tick is due or requested.
  /// @param simulated [s] simulated so far, which is to take as long in real time at speed 1
  Next wait(Simulation& simulation, double simulated);
  /// Only waits until `simulated` [s] are due, for data that is sent between two ticks.
  void keep_pace(double simulated) const;
  /// Publishes a tick to the bridges. @param intents one per report; empty: unknown
  void publish(const base::TickRecord& tick, std::span<const base::Intent> intents = {});
  /// Restarts the run.
  void begin_again();
  /// Returns the world that a user requested, after `Next::world`. The caller writes the outcome and, on success,
  /// restarts and pauses.
  bridges::WorldChange take_world();
  void pause() { state_.paused = true; }

  /// Returns true if at least one bridge publishes the run.
  bool is_watched() const { return !bridges_.empty(); }
  std::uint32_t resets() const { return state_.runs; }

 private:
  using Clock = std::chrono::steady_clock;
  void apply(Simulation& simulation, double simulated);
  void apply_fleet_changes();
  void set_anchor(double simulated);
  void measure(double simulated);
  Clock::time_point due_at(double simulated) const;

  bridges::Bridges& bridges_;
  const std::atomic<bool>& stop_;
  bridges::Requests requests_;
  bridges::RunState state_;
  ChangeFleet change_fleet_;
  std::vector<bridges::Joining> joining_;  ///< waiting for a later tick
  bool loads_worlds_ = false;
  std::optional<bridges::WorldChange> world_;
  std::uint32_t steps_ = 0;  ///< ticks to simulate although paused
  bool reset_ = false;
  Clock::time_point since_;  ///< time since which the run has kept its speed, starting from `from_`
  double from_ = 0.0;        ///< [s] simulated
  Clock::time_point measured_at_;
  double measured_from_ = 0.0;  ///< [s] simulated at `measured_at_`
};

}  // namespace sf::scenarios
