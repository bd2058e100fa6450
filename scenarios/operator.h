#pragma once
// What users of bridges do to a simulated run: they pause it, make single ticks, set its speed, begin it again, drive
// its robots and place them.

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
  /// @param speed [1] simulated over real time, > 0; infinity: as fast as possible
  /// @param stop ends all waiting; it and the bridges outlive the operator
  Operator(bridges::Bridges& bridges, const std::atomic<bool>& stop, double speed);

  static constexpr std::size_t kMostJoining = 4;  ///< robots in one tick, each of which takes time; others wait
  /// Changes of the fleet between two ticks, whose outcomes it writes.
  using ChangeFleet =
      std::function<void(const std::vector<bridges::Joining>& joining, const std::vector<bridges::Leaving>& leaving)>;
  /// Without it, and with null, such requests are refused.
  void on_fleet_changes(ChangeFleet change) { change_fleet_ = std::move(change); }
  /// Whether `wait` returns `Next::world`; else such requests are refused.
  void set_loads_worlds(bool loads) { loads_worlds_ = loads; }

  enum class Next { tick, reset, world, stop };
  /// Does what users asked for, and waits until the run's next tick is due, or asked for.
  /// @param simulated [s] simulated so far, which is to take as long in real time at speed 1
  Next wait(Simulation& simulation, double simulated);
  /// Waits only, until `simulated` [s] are due: for what is sent between two ticks.
  void keep_pace(double simulated) const;
  /// Shows a tick to the bridges.
  void publish(const base::TickRecord& tick);
  /// The run begins again.
  void begin_again();
  /// The world that a user asked for, after `Next::world`: the caller writes the outcome, and begins again and pauses
  /// where it is good.
  bridges::WorldChange take_world();
  void pause() { state_.paused = true; }

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
  std::vector<bridges::Joining> joining_;  ///< that wait for their turn
  bool loads_worlds_ = false;
  std::optional<bridges::WorldChange> world_;
  std::uint32_t steps_ = 0;  ///< ticks to be made although paused
  bool reset_ = false;
  Clock::time_point since_;  ///< since then the run keeps its speed, from `from_` on
  double from_ = 0.0;        ///< [s] simulated
  Clock::time_point measured_at_;
  double measured_from_ = 0.0;  ///< [s] simulated at `measured_at_`
};

}  // namespace sf::scenarios
