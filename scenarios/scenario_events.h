#pragma once
// The events of a scenario during a run: objects appear, disappear, move and change their shapes, robots join and
// leave, lanes change their use.

#include <cstdint>
#include <functional>

#include "scenarios/scenario.h"

namespace sf::scenarios {

/// Checks all events. Adds the robots that join later to `world` and `options`, to check their controllers.
/// @param options one actor per mover
/// @throws base::InputError at the event's line for an unknown object, one with sensors or a controller (a robot cannot
/// vanish from its controller), an invalid robot, or one that would join after the end
void check_events(const Scenario& scenario, world::World& world, SimulationOptions& options);

class ScenarioEvents {
 public:
  /// @param scenario checked; must outlive it
  explicit ScenarioEvents(const Scenario& scenario) : scenario_(scenario) {}

  /// Returns whether a robot that has not joined yet joins by `time` [s].
  bool joins(double time) const;
  /// Applies the events that are due at `time` [s], to half a nanosecond. Called before each step, with increasing
  /// times.
  /// @param world of the simulation; grows with robots that join @param joined called with the row of each new mover
  /// @throws base::InputError at the event's line
  void apply(Simulation& simulation, world::World& world, double time,
             const std::function<void(std::uint32_t)>& joined);

 private:
  bool is_due(std::size_t event, double time) const;

  const Scenario& scenario_;
  std::size_t next_ = 0;
};

}  // namespace sf::scenarios
