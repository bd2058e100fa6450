#include "scenarios/fleet_spawn.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "control/route_plan.h"
#include "robots/footprint.h"
#include "world/free_space.h"
#include "world/ground.h"
#include "world/roads/roads.h"

namespace sf::scenarios {

namespace {

constexpr double kBetween = 0.17;  // [m] minimum gap between two bodies at the start

/// A robot that remains, at its pose in the world or in the scenario.
struct Stays {
  std::uint32_t row = 0;
  base::Pose X_WM;
};

std::vector<Stays> who_stays(const Scenario& scenario, const world::World& world) {
  std::vector<Stays> stays;
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) {
    const world::Mover& mover = world.movers[row];
    for (const RobotSetup& setup : scenario.robot_setups) {
      if (mover.is_tag || setup.name != mover.name) continue;
      stays.push_back({row, setup.pose.value_or(mover.X_WM)});
      break;
    }
  }
  return stays;
}

std::uint32_t original_of(const Scenario& scenario, const world::World& world) {
  const FleetSpawn& fleet = scenario.fleet;
  if (!fleet.of.empty()) {
    const std::uint32_t row = row_of(scenario, world, fleet.of, fleet.line);
    if (!world.movers[row].is_tag) return row;
    throw base::InputError(scenario.file, fleet.line,
                           fmt::format("'{}' is a tag, not a robot; expected a robot to copy", fleet.of));
  }
  if (std::all_of(world.movers.begin(), world.movers.end(), [](const world::Mover& m) { return m.is_tag; }))
    throw base::InputError(scenario.file, fleet.line,
                           fmt::format("{} has no robot to copy; add one to it", scenario.world));
  return world::robot_to_copy(world);
}

bool clear(const base::Pose& X_WM, double radius, const world::World& world, const std::vector<Stays>& stays) {
  return std::all_of(stays.begin(), stays.end(), [&](const Stays& s) {
    const double apart = radius + robots::footprint_of(world.movers[s.row]).radius + kBetween;
    return base::hypot(X_WM.x - s.X_WM.x, X_WM.y - s.X_WM.y) >= apart;
  });
}

/// Draws more poses than needed if some are too close to the remaining robots. Extra draws do not change earlier poses.
std::vector<base::Pose> places_on_lanes(const Scenario& scenario, const world::World& world,
                                        const world::RoadNetwork& roads, const world::Mover& original,
                                        const std::vector<Stays>& stays) {
  const std::size_t wanted = scenario.fleet.robots;
  const double radius = robots::footprint_of(original).radius;
  const double apart = 2.0 * radius + kBetween;
  std::vector<base::Pose> poses;
  for (std::size_t drawn = wanted; poses.size() < wanted; drawn += wanted - poses.size()) {
    try {
      poses = control::start_poses(roads, drawn, scenario.seed, apart);
    } catch (const base::InputError&) {
      throw base::InputError(
          scenario.file, scenario.fleet.line,
          fmt::format(
              "{} robots {:.2f} m apart do not fit on the lanes of {} besides the {} that remain there; use fewer",
              wanted, apart, roads.file, stays.size()));
    }
    std::erase_if(poses, [&](const base::Pose& X) { return !clear(X, radius, world, stays); });
  }
  poses.resize(wanted);
  for (base::Pose& pose : poses) pose.z += world::clearance_of(world, original);
  return poses;
}

void copy_onto_lanes(const Scenario& scenario, world::World& world, std::uint32_t original) {
  if (world.road_files.empty())
    throw base::InputError(scenario.file, scenario.fleet.line,
                           fmt::format("robots on lanes, and {} has no road network; expected a world with "
                                       "road( rndf \"FILE\" ), or place = \"free\"",
                                       scenario.world));
  const world::RoadNetwork roads = *world::roads_of(world);
  const std::vector<Stays> stays = who_stays(scenario, world);
  const auto poses = places_on_lanes(scenario, world, roads, world.movers[original], stays);
  std::vector<std::uint32_t> rows;
  for (const Stays& s : stays) rows.push_back(s.row);
  world::copy_robots(world, original, poses, rows);
}

}  // namespace

void spawn_fleet(const Scenario& scenario, world::World& world) {
  const std::uint32_t original = original_of(scenario, world);
  if (scenario.fleet.place == FleetSpawn::Placement::lanes) return copy_onto_lanes(scenario, world, original);
  world::clone_robots(world, scenario.fleet.robots, scenario.seed, world.movers[original].name);
}

}  // namespace sf::scenarios
