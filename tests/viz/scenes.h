#pragma once
// Synthetic worlds, paths and scans for the tests of figures, without files or devices.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "sensors/laser_settings.h"
#include "viz/trajectory_figure.h"
#include "world/world.h"

namespace sf::scenes {

using base::Pose;

/// Adds the four walls of a rectangle, solid inside (or outside: the walls of a room).
inline void add_box(world::World& world, double x0, double y0, double x1, double y1, std::uint32_t model,
                    bool room = false) {
  std::vector<glm::dvec2> p{{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  if (room) std::reverse(p.begin(), p.end());
  for (std::size_t i = 0; i < 4; ++i) world.walls.push_back({p[i], p[(i + 1) % 4], 0.0, 1.0, model, true, true, true});
}

inline std::uint32_t add_model(world::World& world, const std::string& name, std::uint32_t color, bool bitmap = false) {
  world::Model model;
  model.name = name;
  model.type = "model";
  model.color = color;
  model.is_bitmap = bitmap;
  world.models.push_back(model);
  return static_cast<std::uint32_t>(world.models.size() - 1);
}

/// Adds a round robot of radius 0.165 m with a laser ahead of its centre.
inline world::Mover make_robot(world::World& world, std::uint32_t id, const Pose& X_WM, std::uint32_t color,
                               double range_max) {
  world::Mover mover;
  mover.name = fmt::format("r{}", id);
  mover.model = add_model(world, mover.name, color);
  mover.id = id;
  mover.X_WM = X_WM;
  mover.radius = 0.165;
  for (int i = 0; i < 16; ++i)
    mover.body.push_back({base::rotate(i * M_PI / 8, {0.165, 0.0}), base::rotate((i + 1) % 16 * M_PI / 8, {0.165, 0.0}),
                          0.0, 0.1, mover.model, true, true, true});
  sensors::LaserSettings laser;
  laser.X_MS = {0.1, 0.0, 0.1, 0.0};
  laser.range_max = range_max;
  laser.fov = 1.5 * M_PI;
  mover.sensors.push_back(sensors::laser_sensor(laser));
  return mover;
}

inline bool inside_block(const world::World& world, glm::dvec2 p, double clearance) {
  for (std::size_t i = 4; i + 3 < world.walls.size(); i += 4) {
    const world::Segment& low = world.walls[i];
    const world::Segment& high = world.walls[i + 2];
    if (p.x > low.a.x - clearance && p.x < high.a.x + clearance && p.y > low.a.y - clearance &&
        p.y < high.a.y + clearance)
      return true;
  }
  return p.x < clearance || p.y < clearance || p.x > world.extent.x_max - 0.5 - clearance ||
         p.y > world.extent.y_max - 0.5 - clearance;
}

/// A walled room of `width` x `height` m with its corner at the origin, 0.5 m thick walls, blocks in it, and robots.
inline world::World make_world(double width, double height, int blocks, std::uint32_t robots, double range_max = 4.0,
                               std::uint32_t seed = 1) {
  std::mt19937 draw(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  world::World world;
  world.name = "mock room";
  world.extent = {-0.5, -0.5, width + 0.5, height + 0.5};
  const std::uint32_t plan = add_model(world, "plan", 0xFF404040u, true);
  add_box(world, 0.0, 0.0, width, height, plan, true);
  for (int k = 0; k < blocks; ++k) {
    const double w = 0.4 + 1.6 * unit(draw);
    const double h = k % 3 == 0 ? 0.2 : 0.4 + 1.2 * unit(draw);
    const double x = 0.5 + unit(draw) * (width - w - 1.0);
    const double y = 0.5 + unit(draw) * (height - h - 1.0);
    const std::uint32_t model = k % 4 == 0 ? add_model(world, fmt::format("block{}", k), 0xFFB5651Du) : plan;
    add_box(world, x, y, x + w, y + h, model);
  }
  add_box(world, -0.5, -0.5, width + 0.5, height + 0.5, plan);
  world.extent = {-0.5, -0.5, width + 0.5, height + 0.5};
  for (std::uint32_t k = 0; k < robots; ++k) {
    glm::dvec2 p{};
    std::size_t skip_outer = world.walls.size() - 4;
    do p = {unit(draw) * width, unit(draw) * height};
    while ([&] {
      world::World inner = {};
      inner.extent = world.extent;
      inner.walls.assign(world.walls.begin(), world.walls.begin() + static_cast<std::ptrdiff_t>(skip_outer));
      return inside_block(inner, p, 0.2);
    }());
    world.movers.push_back(make_robot(world, k, {p.x, p.y, 0.0, 2.0 * M_PI * unit(draw)}, 0xFF2E7D32u, range_max));
  }
  return world;
}

/// [m] Returns the range along `bearing` to the first wall, at most range_max.
inline double cast(const world::World& world, glm::dvec2 p, double bearing, double range_max) {
  const glm::dvec2 d = base::rotate(bearing, {1.0, 0.0});
  double best = range_max;
  for (const world::Segment& s : world.walls) {
    const glm::dvec2 e = s.b - s.a;
    const double across = base::cross(d, e);
    if (across == 0.0) continue;
    const double t = base::cross(s.a - p, e) / across;
    const double u = base::cross(s.a - p, d) / across;
    if (t >= 0.0 && t < best && u >= 0.0 && u <= 1.0) best = t;
  }
  return best;
}

inline std::vector<double> scan(const world::World& world, const Pose& X_WS, double fov, int beams, double range_max) {
  std::vector<double> ranges;
  for (int k = 0; k < beams; ++k)
    ranges.push_back(cast(world, {X_WS.x, X_WS.y}, X_WS.yaw - 0.5 * fov + fov * k / (beams - 1), range_max));
  return ranges;
}

}  // namespace sf::scenes
