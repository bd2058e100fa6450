#pragma once
// The events of a scenario in a run: objects that come and go.

#include <cstdint>
#include <vector>

#include "scenarios/scenario.h"

namespace sf::scenarios {

class ScenarioEvents {
 public:
  /// @param scenario must outlive it
  /// @throws base::InputError for an unknown object, and for one with sensors or a controller: a robot cannot vanish
  /// from its controller
  ScenarioEvents(const Scenario& scenario, const world::World& world, const SimulationOptions& options);

  /// Applies the events that are due at `time` [s], to half a nanosecond. Called before each step, with growing times.
  void apply(Simulation& simulation, double time);

 private:
  const std::vector<ObjectEvent>& events_;
  std::vector<std::uint32_t> objects_;  ///< per event: its mover
  std::size_t next_ = 0;
};

}  // namespace sf::scenarios
