#pragma once
// Small worlds built by hand, shared by the tests of robots and control.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/random.h"
#include "world/world.h"

namespace sf::scenes {

using base::Pose;

inline void add_wall(world::World& world, glm::dvec2 a, glm::dvec2 b, double z_min = 0.0, double z_max = 1.0) {
  world.walls.push_back({.a = a, .b = b, .z_min = z_min, .z_max = z_max, .model = 0, .solid_left = false});
}

/// Adds a closed outline in the order of `corners`. A counter-clockwise one has its solid inside.
inline void add_outline(std::vector<world::Segment>& to, const std::vector<glm::dvec2>& corners, double z_min = 0.0,
                        double z_max = 1.0) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    to.push_back({.a = corners[i], .b = corners[(i + 1) % corners.size()], .z_min = z_min, .z_max = z_max});
  }
}

inline std::vector<glm::dvec2> rectangle(glm::dvec2 centre, double length, double width) {
  const double x = length / 2.0, y = width / 2.0;
  return {{centre.x - x, centre.y - y},
          {centre.x + x, centre.y - y},
          {centre.x + x, centre.y + y},
          {centre.x - x, centre.y + y}};
}

/// Returns a world with one static model and no walls.
inline world::World empty_world() {
  world::World world;
  world.name = "scene";
  world.file = "scene.world";
  world.models.push_back({.name = "walls", .type = "model"});
  return world;
}

/// Returns a world with four thin walls around [x0, x0 + width] x [y0, y0 + height].
inline world::World boxed_world(double width, double height, glm::dvec2 corner = {}) {
  world::World world = empty_world();
  const glm::dvec2 p = corner, q{corner.x + width, corner.y + height};
  add_wall(world, p, {q.x, p.y});
  add_wall(world, {q.x, p.y}, q);
  add_wall(world, q, {p.x, q.y});
  add_wall(world, {p.x, q.y}, p);
  return world;
}

/// Adds a mover whose body is one outline with heights [0, 0.1].
inline world::Mover& add_mover(world::World& world, const Pose& X_WM, const std::vector<glm::dvec2>& corners) {
  world::Mover mover;
  mover.name = "robot" + std::to_string(world.movers.size() + 1);
  mover.id = static_cast<std::uint32_t>(world.movers.size() + 1);
  mover.model = static_cast<std::uint32_t>(world.models.size());
  mover.X_WM = X_WM;
  add_outline(mover.body, corners, 0.0, 0.1);
  for (world::Segment& s : mover.body) {
    s.model = mover.model;
    mover.radius = std::max(mover.radius, length(s.a));
  }
  world.models.push_back(
      {.name = mover.name, .type = "position", .mover = static_cast<std::uint32_t>(world.movers.size()), .X_WM = X_WM});
  world.movers.push_back(mover);
  return world.movers.back();
}

/// Adds a 16-sided disc of radius 0.165 m with at most 0.5 m/s and 90 degrees per second.
inline world::Mover& add_create(world::World& world, const Pose& X_WM) {
  std::vector<glm::dvec2> corners;
  for (int i = 0; i < 16; ++i) corners.push_back(0.165 * glm::dvec2{std::cos(M_PI * i / 8), std::sin(M_PI * i / 8)});
  return add_mover(world, X_WM, corners);
}

/// Adds a square of edge 0.4 m.
inline world::Mover& add_square(world::World& world, const Pose& X_WM) {
  return add_mover(world, X_WM, rectangle({}, 0.4, 0.4));
}

/// Adds a picture of cells, `true` is solid, as boundary segments merged into runs with the solid on their left.
inline void add_bitmap(world::World& world, const std::vector<std::vector<bool>>& solid, double cell) {
  const int rows = static_cast<int>(solid.size()), columns = static_cast<int>(solid.front().size());
  const auto at = [&](int x, int y) { return x >= 0 && y >= 0 && x < columns && y < rows && solid[y][x]; };
  const auto add = [&](glm::dvec2 a, glm::dvec2 b) {
    world.walls.push_back({.a = cell * a, .b = cell * b, .z_min = 0.0, .z_max = 1.0});
  };
  // Edges between a row and the one below; the same for columns after that.
  for (int y = 0; y <= rows; ++y) {
    for (int x = 0; x < columns;) {
      const bool up = at(x, y) && !at(x, y - 1), down = !at(x, y) && at(x, y - 1);
      int end = x + 1;
      while ((up || down) && end < columns && at(end, y) == at(x, y) && at(end, y - 1) == at(x, y - 1)) ++end;
      if (up) add({double(x), double(y)}, {double(end), double(y)});
      if (down) add({double(end), double(y)}, {double(x), double(y)});
      x = end;
    }
  }
  for (int x = 0; x <= columns; ++x) {
    for (int y = 0; y < rows;) {
      const bool right = at(x, y) && !at(x - 1, y), left = !at(x, y) && at(x - 1, y);
      int end = y + 1;
      while ((right || left) && end < rows && at(x, end) == at(x, y) && at(x - 1, end) == at(x - 1, y)) ++end;
      if (right) add({double(x), double(end)}, {double(x), double(y)});
      if (left) add({double(x), double(y)}, {double(x), double(end)});
      y = end;
    }
  }
}

/// Returns a closed cave of columns x rows cells: noise smoothed by majority, with a solid rim.
inline std::vector<std::vector<bool>> cave(int columns, int rows, std::uint64_t seed, double fill = 0.44,
                                           int rounds = 4) {
  std::vector<std::vector<bool>> solid(rows, std::vector<bool>(columns, true));
  for (int y = 1; y + 1 < rows; ++y) {
    for (int x = 1; x + 1 < columns; ++x) {
      const auto u = base::random_uniform({.seed = seed, .a = std::uint32_t(x), .b = std::uint32_t(y)}, 0);
      solid[y][x] = u[0] < fill;
    }
  }
  for (int round = 0; round < rounds; ++round) {
    const auto before = solid;
    for (int y = 1; y + 1 < rows; ++y) {
      for (int x = 1; x + 1 < columns; ++x) {
        int count = 0;
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) count += before[y + dy][x + dx];
        }
        solid[y][x] = count >= 5;
      }
    }
  }
  return solid;
}

/// Returns a row of magnetometers across the front of a robot, with element 0 in the middle.
inline world::Sensor magnetometers(int count) {
  world::Sensor sensor{.type = "magnetometer"};
  sensor.settings.push_back({.key = "scount", .numbers = {1.0 * count}});
  for (int i = 0; i < count; ++i)
    sensor.settings.push_back({.key = "spose[" + std::to_string(i) + "]", .numbers = {0.2, 0.075 * i, 0.0}});
  return sensor;
}

}  // namespace sf::scenes
