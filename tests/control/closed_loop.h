#pragma once
// Closed loop of one robot, its controller and brute-force sensors, tick by tick.

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "control/controllers.h"
#include "robots/fleet.h"
#include "sensors/laser.h"
#include "sensors/laser_settings.h"
#include "sensors/magnetometer.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"
#include "world/path_geometry.h"
#include "world/world.h"

namespace sf::loop {

using base::Pose;
using base::Twist;

/// The thesis' path, and a Create with a lane edge sensor and five magnetometers. @param yaw [rad] of the lane edge
/// sensor
inline world::World path_world(double yaw = M_PI / 2) {
  world::World world = scenes::empty_world();
  world::Mover& robot = scenes::add_create(world, {0, 0, 0, 0});
  robot.sensors.push_back({.type = "laneedge", .X_MS = {0.225, 0, 0, yaw}});
  robot.sensors.push_back(scenes::magnetometers(5));
  world.paths.push_back({"lane",
                         {{{0, 0, 0, 0}, 2.72, 0.0, 0.50},
                          {{2.72, 0, 0, 0}, 0.93 * M_PI / 2, 1 / 0.93, 0.60},
                          {{3.65, 0.93, 0, M_PI / 2}, 1.349, 0.0, 0.45}}});
  return world;
}

/// Distance to the left edge by formula, as measured by an ideal lane edge sensor on a straight lane.
inline std::vector<double> edge_from(const world::World& world, const Pose& X_WM) {
  const world::PathProjection at = world::project_onto(world.paths[0], transform(X_WM, {0.225, 0.0}));
  return {0.5 * world.paths[0].pieces[at.piece].width - at.offset, 61, 0, 0};
}

/// Five elements over a line whose field is largest above it, with the columns of the magnetometer.
inline std::vector<double> field_over(const world::World& world, const Pose& X_WM) {
  std::vector<double> values;
  for (int i = 0; i < 5; ++i) {
    const double far = world::project_onto(world.paths[0], transform(X_WM, {0.2, -0.15 + 0.075 * i})).offset;
    const double field = 1.81 * sensors::kGauss / (1.0 + far * far / 0.015);
    values.insert(values.end(), {field, 0.0, 0.0, field});
  }
  return values;
}

/// Returns the ranges of a laser, considering only walls.
inline std::vector<double> scan(const world::World& world, const sensors::LaserSettings& laser, const Pose& X_WS) {
  // Walls out of range are excluded once for all beams.
  std::vector<const world::Segment*> near;
  for (const auto& wall : world.walls)
    if (wall.seen_by_laser && wall.z_min <= X_WS.z && X_WS.z < wall.z_max &&
        world::distance({X_WS.x, X_WS.y}, wall.a, wall.b) <= laser.range_max)
      near.push_back(&wall);
  std::vector<double> ranges;
  for (std::uint32_t i = 0; i < laser.samples; ++i) {
    const double bearing = X_WS.yaw + bearing_of(laser, i);
    const glm::dvec2 u{std::cos(bearing), std::sin(bearing)}, p{X_WS.x, X_WS.y};
    double range = laser.range_max;
    for (const world::Segment* wall : near) {
      const double area = base::cross(u, wall->b - wall->a);
      const double t = base::cross(wall->a - p, wall->b - wall->a) / area, s = base::cross(wall->a - p, u) / area;
      if (area != 0.0 && t >= 0.0 && s >= 0.0 && s <= 1.0) range = std::min(range, t);
    }
    ranges.push_back(range);
  }
  return ranges;
}

/// A single robot: laser 0 at its own rate, a tick of 0.1 s.
struct LaserRun {
  LaserRun(const world::World& w, control::Controller& c) : world(w), controller(c), fleet(w) { look(); }

  void tick() {
    const std::int64_t now = fleet.reports()[0].time;
    const base::ReadingBlock block{.type = sensors::kLaser,
                                   .sequence = sequence,
                                   .time = seen_at,
                                   .X_WM = X_WM,
                                   .X_WS = compose(X_WM, sensors::lasers_of(world.movers[0])[0].X_MS),
                                   .values = ranges};
    const Twist twist = controller.step(
        {.time = now, .state = fleet.reports()[0], .readings = {&block, 1}, .contact = fleet.contacts()[0] != 0});
    finite = finite && std::isfinite(twist.forward) && std::isfinite(twist.turn);
    // Readings fall between ticks.
    const auto period = static_cast<std::int64_t>(1e9 / sensors::lasers_of(world.movers[0])[0].rate);
    for (std::int64_t left = kTick; left > 0;) {
      const std::int64_t part = std::min(left, seen_at + period - fleet.reports()[0].time);
      const Twist command[] = {twist};
      if (part > 0) fleet.move(command, part);
      contacts += fleet.contacts()[0];
      left -= part;
      if (fleet.reports()[0].time >= seen_at + period) look();
    }
    distance += std::abs(fleet.reports()[0].velocity.forward) * 0.1;
  }
  void look() {
    const sensors::LaserSettings laser = sensors::lasers_of(world.movers[0])[0];
    X_WM = fleet.reports()[0].X_WM;
    ranges = scan(world, laser, compose(X_WM, laser.X_MS));
    seen_at = fleet.reports()[0].time;
    ++sequence;
  }

  const world::World& world;
  control::Controller& controller;
  robots::Fleet fleet;
  std::vector<double> ranges;
  Pose X_WM;
  std::int64_t seen_at = 0;
  std::uint32_t sequence = 0;
  int contacts = 0;
  double distance = 0.0;  ///< [m]
  bool finite = true;
};

}  // namespace sf::loop
