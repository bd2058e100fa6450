#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "control/explore.h"
#include "robots/footprint.h"
#include "sensors/laser.h"

namespace sf::control {

namespace {

constexpr double kMostNodes = 2e6;  // nodes of the lattice: 128 MB for the path search

}  // namespace

maps::GridGeometry grid_around(const world::World& world, double cell) {
  world::Extent extent = world.extent;
  maps::GridGeometry geometry{.cell = cell};
  const auto words = [&](double length) { return std::max(30.0, std::ceil(length / (4.0 * cell) + 2.0)); };
  const double wide = words(extent.x_max - extent.x_min), high = words(extent.y_max - extent.y_min);
  if (!(wide * high * 144.0 <= kMostNodes))
    throw base::InputError(
        fmt::format("'explore': the world is {:.0f} m x {:.0f} m; expected at most {:.0f} square "
                    "metres; give the area as map_left, map_top, map_width and map_height",
                    extent.x_max - extent.x_min, extent.y_max - extent.y_min, kMostNodes / 9.0 * cell * cell));
  geometry.word_columns = static_cast<std::uint32_t>(wide);
  geometry.word_rows = static_cast<std::uint32_t>(high);
  geometry.left = 0.5 * (extent.x_min + extent.x_max) - 2.0 * wide * cell;
  geometry.top = 0.5 * (extent.y_min + extent.y_max) + 2.0 * high * cell;
  return geometry;
}

namespace {

// Distances in a moving world are several times as large, as poses and surfaces are less precise.
constexpr double kMovingCell = 0.09, kMovingMargin = 0.15, kMovingLeastMargin = 0.1;  // [m]

maps::GridGeometry read_geometry(const ControllerContext& context, Settings& settings, bool moving) {
  const double cell = settings.number("cell", moving ? kMovingCell : 0.03, 0.005, 1.0);
  const bool given = settings.has("map_width") || settings.has("map_height");
  if (!given) return grid_around(context.world, cell);
  maps::GridGeometry geometry{.cell = cell};
  geometry.left = settings.number("map_left", 0.0, -1e6, 1e6);
  geometry.top = settings.number("map_top", 0.0, -1e6, 1e6);
  const double wide = std::ceil(settings.number("map_width", 3.6, cell, 1e3) / (4.0 * cell) - 1e-9);
  const double high = std::ceil(settings.number("map_height", 3.6, cell, 1e3) / (4.0 * cell) - 1e-9);
  if (!(wide * high * 144.0 <= kMostNodes)) settings.refuse("map_width", "'map_width' times 'map_height' is too large");
  geometry.word_columns = static_cast<std::uint32_t>(wide);
  geometry.word_rows = static_cast<std::uint32_t>(high);
  return geometry;
}

TeamSettings read_team(const ControllerContext& context, Settings& settings, double radius) {
  TeamSettings team{.id = context.world.movers[context.mover].id, .radius = radius, .others = radius};
  team.radio = settings.number("radio", team.radio, 0.5, 1e6);
  for (const world::Mover& other : context.world.movers)
    if (!other.is_tag) team.others = std::max(team.others, robots::footprint_of(other).radius);
  return team;
}

std::unique_ptr<Controller> make_explore(const ControllerContext& context, Settings& settings) {
  const world::Mover& mover = context.world.movers[context.mover];
  const std::vector<sensors::SensorSpec> lasers = context.sensors_of(sensors::kLaser);
  if (lasers.empty())
    throw base::InputError(
        fmt::format("controller 'explore': '{}' has no laser; give it one in the world file", mover.name));
  if (mover.drive == world::Drive::car)
    throw base::InputError(
        fmt::format("controller 'explore': '{}' is a car; expected a drive that turns in place", mover.name));
  const sensors::SensorSpec& laser = lasers.front();
  ExploreSettings explore;
  explore.moving = settings.flag("moving", explore.moving);
  if (explore.moving) explore.swept_area = read_swept_area(context, settings);
  explore.geometry = read_geometry(context, settings, explore.moving);
  explore.body = {robots::footprint_of(mover).radius, {laser.X_MS.x, laser.X_MS.y}};
  explore.eye = {laser.X_MS, laser.fov, laser.limit};
  explore.beams = maps::beam_directions(laser.fov, laser.elements);
  explore.range_min = laser.range_min;
  explore.speed = settings.number("speed", std::min(explore.speed, mover.max_forward), 1e-3, mover.max_forward);
  explore.slow_speed = settings.number("slow_speed", std::min(explore.slow_speed, explore.speed), 1e-3, explore.speed);
  explore.slow = settings.number("slow", explore.slow, 0.0, 1.0);
  explore.turn = settings.number("turn_speed", std::min(explore.turn, mover.max_turn), 1e-2, mover.max_turn);
  explore.margin = settings.number("margin", explore.moving ? kMovingMargin : explore.margin, 0.0, 1.0);
  explore.least_margin = explore.moving ? kMovingLeastMargin : explore.least_margin;
  explore.least_margin =
      settings.number("least_margin", std::min(explore.least_margin, explore.margin), 0.0, explore.margin);
  explore.view = settings.number("view", laser.limit, 0.1, 1e3);
  explore.thorough = settings.flag("thorough", explore.thorough);
  if (settings.flag("team", false)) explore.team = read_team(context, settings, explore.body.radius);
  return std::make_unique<Explore>(explore);
}

}  // namespace

constinit const ControllerType explore_controller{
    .name = "explore",
    .summary = "maps an area by laser: drives to unexplored cells and avoids contacts",
    .rate = 10.0,
    .stops_on_bumper = false,
    .make = make_explore,
};

}  // namespace sf::control
