#include "scenarios/scenario_events.h"

#include <fmt/format.h>

#include "base/error.h"

namespace sf::scenarios {

ScenarioEvents::ScenarioEvents(const Scenario& scenario, const world::World& world, const SimulationOptions& options)
    : events_(scenario.events) {
  for (const ObjectEvent& event : events_) {
    const std::uint32_t row = row_of(scenario, world, event.object, event.line);
    if (!world.movers[row].sensors.empty() || !options.actors[row].controller.name.empty())
      throw base::InputError(scenario.file, event.line,
                             fmt::format("'{}' has sensors or a controller; expected an object without, such as a "
                                         "model named tag1",
                                         event.object));
    objects_.push_back(row);
  }
}

void ScenarioEvents::apply(Simulation& simulation, double time) {
  for (; next_ < events_.size() && events_[next_].at <= time + 5e-10; ++next_)
    simulation.set_absent(objects_[next_], !events_[next_].present);
}

}  // namespace sf::scenarios
