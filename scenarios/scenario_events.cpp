#include "scenarios/scenario_events.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "world/append_robot.h"
#include "world/roads/lane_control.h"
#include "world/roads/roads.h"

namespace sf::scenarios {

namespace {

/// Calls `act()` and adds the event's line to its errors.
template <class Act>
void at_line(const Scenario& scenario, const ObjectEvent& event, Act&& act) {
  try {
    act();
  } catch (const base::InputError& error) {
    const std::string what = error.what();
    if (what.starts_with(scenario.file + ":")) throw;
    throw base::InputError(scenario.file, event.line, what);
  }
}

/// Returns whether a robot of that name is present until the event.
bool returns(const Scenario& scenario, const ObjectEvent& event, const world::World& world) {
  return std::any_of(world.movers.begin(), world.movers.end(),
                     [&](const world::Mover& mover) { return mover.name == event.object; }) &&
         std::any_of(scenario.events.begin(), scenario.events.end(), [&](const ObjectEvent& other) {
           return other.kind == ObjectEvent::Kind::remove && other.object == event.object && other.at <= event.at;
         });
}

void join(const Scenario& scenario, const ObjectEvent& event, world::World& world, SimulationOptions& options) {
  if (event.at >= scenario.duration)
    throw base::InputError(scenario.file, event.line,
                           fmt::format("'{}' would join after the end; expected 'at' below the duration of {:g} s",
                                       event.object, scenario.duration));
  at_line(scenario, event, [&] {
    const std::uint32_t original = world::robot_like(world, event.joining.like);
    if (returns(scenario, event, world)) return;
    world::check_name(world, event.object);
    world::append_robot(world, original, event.object, event.joining.X_WM);
    options.actors.push_back(event.joining.actor);
  });
}

void place(Simulation& simulation, const world::Mover& mover, std::uint32_t row, const ObjectEvent& event) {
  if (simulation.share().passed_on())
    throw base::InputError("poses cannot be set with --tiles; expected ranks that share the whole world");
  if (!mover.is_tag && simulation.is_absent(row))
    throw base::InputError(
        fmt::format("'{}' was removed; expected a pose before that, or after it has been added again", mover.name));
  simulation.put(row, event.X_WM, event.tilt);
}

/// Checks that each change of lane use is possible after those before it.
void check_lanes(const Scenario& scenario, const world::World& world) {
  std::optional<world::LaneControl> lanes;
  for (const ObjectEvent& event : scenario.events) {
    if (event.kind != ObjectEvent::Kind::lane) continue;
    at_line(scenario, event, [&] {
      const auto roads = world::roads_of(world);
      if (!roads) throw base::InputError("the world has no road network; expected road( rndf \"...\" ) in it");
      if (!lanes) lanes.emplace(*roads);
      lanes->request(lane_named(lanes->base(), event.object), world::lane_use_of(event.use));
    });
  }
}

}  // namespace

void check_events(const Scenario& scenario, world::World& world, SimulationOptions& options) {
  for (const ObjectEvent& event : scenario.events)
    if (event.kind == ObjectEvent::Kind::add) join(scenario, event, world, options);
  check_lanes(scenario, world);
  for (const ObjectEvent& event : scenario.events) {
    if (event.kind == ObjectEvent::Kind::add || event.kind == ObjectEvent::Kind::lane) continue;
    const std::uint32_t row = row_of(scenario, world, event.object, event.line);
    if (event.kind == ObjectEvent::Kind::remove || event.kind == ObjectEvent::Kind::pose) continue;
    if (event.kind == ObjectEvent::Kind::shape) {
      at_line(scenario, event, [&] { world::check_change(world, row, event.shape); });
      continue;
    }
    if (!world.movers[row].sensors.empty() || !options.actors[row].controller.name.empty())
      throw base::InputError(scenario.file, event.line,
                             fmt::format("'{}' has sensors or a controller; expected an object without, such as a "
                                         "model named tag1",
                                         event.object));
  }
}

bool ScenarioEvents::is_due(std::size_t event, double time) const {
  return event < scenario_.events.size() && scenario_.events[event].at <= time + 5e-10;
}

bool ScenarioEvents::joins(double time) const {
  for (std::size_t event = next_; is_due(event, time); ++event)
    if (scenario_.events[event].kind == ObjectEvent::Kind::add) return true;
  return false;
}

void ScenarioEvents::apply(Simulation& simulation, world::World& world, double time,
                           const std::function<void(std::uint32_t)>& joined) {
  for (; is_due(next_, time); ++next_) {
    const ObjectEvent& event = scenario_.events[next_];
    const std::size_t before = world.movers.size();
    if (event.kind == ObjectEvent::Kind::add) {
      std::uint32_t row = 0;
      at_line(scenario_, event, [&] { row = simulation.add_robot(world, event.joining); });
      if (row >= before) joined(row);
      continue;
    }
    if (event.kind == ObjectEvent::Kind::lane) {
      at_line(scenario_, event, [&] { simulation.set_lane(event.object, event.use); });
      continue;
    }
    const std::uint32_t row = row_of(scenario_, world, event.object, event.line);
    if (event.kind == ObjectEvent::Kind::shape)
      at_line(scenario_, event, [&] { simulation.set_shape(world, row, event.shape); });
    else if (event.kind == ObjectEvent::Kind::pose)
      at_line(scenario_, event, [&] { place(simulation, world.movers[row], row, event); });
    else if (event.kind == ObjectEvent::Kind::object)
      simulation.set_absent(row, !event.present);
    else
      at_line(scenario_, event, [&] { simulation.remove_robot(row); });
  }
}

}  // namespace sf::scenarios
