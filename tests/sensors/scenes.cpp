#include "tests/sensors/scenes.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "sensors/laser_settings.h"

namespace sf::scenes {

namespace {

struct Cells {
  std::uint32_t n;
  std::vector<char> solid;
  bool at(std::int64_t x, std::int64_t y) const {
    return x >= 0 && y >= 0 && x < n && y < n && solid[static_cast<std::size_t>(y) * n + static_cast<std::size_t>(x)];
  }
};

/// Smooth blobs: the sign of a sum of a few waves; the border is solid.
Cells grow(std::uint32_t n, std::uint64_t seed) {
  Cells cells{n, std::vector<char>(static_cast<std::size_t>(n) * n)};
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      double sum = 0.0;
      for (std::uint32_t k = 0; k < 12; ++k) {
        const auto u = base::random_uniform({seed, base::RandomStream::placement, k, 0, 0}, 0);
        const auto v = base::random_uniform({seed, base::RandomStream::placement, k, 1, 0}, 0);
        const double wave = 2.0 * M_PI * (2.0 + 9.0 * u[0]);
        const double angle = 2.0 * M_PI * u[1];
        sum += std::sin(wave * (x * std::cos(angle) + y * std::sin(angle)) / n + 2.0 * M_PI * v[0]);
      }
      const bool border = x < 3 || y < 3 || x + 3 >= n || y + 3 >= n;
      cells.solid[static_cast<std::size_t>(y) * n + x] = border || sum > 1.2;
    }
  return cells;
}

void add_segment(world::World& world, glm::dvec2 a, glm::dvec2 b) {
  world::Segment s;
  s.a = a;
  s.b = b;
  s.z_max = 1.0;
  world.walls.push_back(s);
}

/// Adds runs of boundary along x (or, transposed, along y), straight with the solid on one side.
void add_runs(world::World& world, const Cells& cells, double cell, bool transposed) {
  const auto solid = [&](std::int64_t x, std::int64_t y) { return transposed ? cells.at(y, x) : cells.at(x, y); };
  const double half = 0.5 * cells.n * cell;
  const auto point = [&](std::int64_t x, std::int64_t y) {
    const glm::dvec2 p{static_cast<double>(x) * cell - half, static_cast<double>(y) * cell - half};
    return transposed ? glm::dvec2{p.y, p.x} : p;
  };
  for (std::int64_t y = 0; y <= cells.n; ++y)
    for (std::int64_t x = 0; x < cells.n;) {
      const bool below = solid(x, y - 1);
      if (below == solid(x, y)) {
        ++x;
        continue;
      }
      const std::int64_t start = x;
      while (x < cells.n && solid(x, y - 1) == below && solid(x, y) != below) ++x;
      // The solid above a run along +x is on its left. Transposing mirrors it.
      const bool forward = below == transposed;
      if (forward)
        add_segment(world, point(start, y), point(x, y));
      else
        add_segment(world, point(x, y), point(start, y));
    }
}

}  // namespace

world::World cave(std::uint32_t n, double size, std::uint64_t seed) {
  world::World world;
  world.models.push_back({"cave", "model"});
  const Cells cells = grow(n, seed);
  add_runs(world, cells, size / n, false);
  add_runs(world, cells, size / n, true);
  world.extent = {-0.5 * size, -0.5 * size, 0.5 * size, 0.5 * size};
  return world;
}

void add_outline(world::World& world, const std::vector<glm::dvec2>& corners, const std::string& name) {
  world.models.push_back({name, "model"});
  for (std::size_t i = 0; i < corners.size(); ++i) {
    add_segment(world, corners[i], corners[(i + 1) % corners.size()]);
    world.walls.back().model = static_cast<std::uint32_t>(world.models.size() - 1);
  }
}

void add_room(world::World& world, glm::dvec2 centre, double size) {
  const double h = 0.5 * size;
  const double g = h + 0.1;
  const auto at = [centre](double x, double y) { return centre + glm::dvec2{x, y}; };
  add_outline(world, {at(-g, -g), at(g, -g), at(g, g), at(-g, g)}, "border");
  add_outline(world, {at(-h, -h), at(-h, h), at(h, h), at(h, -h)}, "border");
}

world::World boxes(std::uint32_t count, double size, std::uint64_t seed) {
  world::World world;
  const double h = 0.5 * size;
  add_room(world, {}, size);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto p = base::random_uniform({seed, base::RandomStream::placement, i, 2, 0}, 0);
    const auto q = base::random_uniform({seed, base::RandomStream::placement, i, 3, 0}, 0);
    const base::Pose pose{(p[0] - 0.5) * 0.9 * size, (p[1] - 0.5) * 0.9 * size, 0.0, 2.0 * M_PI * q[0]};
    const double a = 0.2 + 0.6 * q[1];
    std::vector<glm::dvec2> corners;
    for (const glm::dvec2& corner :
         {glm::dvec2{-a, -0.3}, glm::dvec2{a, -0.3}, glm::dvec2{a, 0.3}, glm::dvec2{-a, 0.3}})
      corners.push_back(transform(pose, corner));
    add_outline(world, corners, "box" + std::to_string(i));
  }
  world.extent = {-h, -h, h, h};
  return world;
}

sensors::LaserSettings laser(std::uint32_t samples, double fov, double range_max) {
  sensors::LaserSettings laser;
  laser.name = "laser";
  laser.X_MS = {0.1, 0.0, 0.1, 0.0};
  laser.samples = samples;
  laser.fov = fov;
  laser.range_max = range_max;
  return laser;
}

std::uint32_t add_robot(world::World& world, const base::Pose& pose, const sensors::LaserSettings& laser) {
  world::Mover mover;
  const auto number = static_cast<std::uint32_t>(world.movers.size());
  mover.name = "roomba" + std::to_string(number + 1);
  mover.id = number + 1;
  mover.model = static_cast<std::uint32_t>(world.models.size());
  mover.X_WM = pose;
  mover.radius = 0.165;
  world.models.push_back({mover.name, "position"});
  world.models.back().mover = number;
  for (int i = 0; i < 16; ++i) {
    world::Segment s;
    s.a = base::rotate(i * M_PI / 8.0, {mover.radius, 0.0});
    s.b = base::rotate((i + 1) * M_PI / 8.0, {mover.radius, 0.0});
    s.z_max = 0.2;
    s.model = mover.model;
    mover.body.push_back(s);
  }
  for (std::size_t i = 0; i < mover.body.size(); ++i) mover.body[i].b = mover.body[(i + 1) % mover.body.size()].a;
  mover.sensors.push_back(sensors::laser_sensor(laser));
  world.movers.push_back(mover);
  return number;
}

namespace {

bool is_free(const world::World& world, glm::dvec2 p, double radius, double apart) {
  int winding = 0;
  for (const world::Segment& s : world.walls) {
    const glm::dvec2 e = s.b - s.a;
    const double u = std::clamp(dot(p - s.a, e) / dot(e, e), 0.0, 1.0);
    if (length(p - (s.a + u * e)) < radius) return false;
    if (s.a.y <= p.y && s.b.y > p.y && base::cross(e, p - s.a) > 0.0) ++winding;
    if (s.a.y > p.y && s.b.y <= p.y && base::cross(e, p - s.a) < 0.0) --winding;
  }
  if (winding != 0) return false;
  return std::none_of(world.movers.begin(), world.movers.end(), [&](const world::Mover& m) {
    return length(p - glm::dvec2{m.X_WM.x, m.X_WM.y}) < apart;
  });
}

}  // namespace

void add_robots(world::World& world, std::uint32_t count, const sensors::LaserSettings& laser, std::uint64_t seed) {
  const double width = world.extent.x_max - world.extent.x_min;
  const double height = world.extent.y_max - world.extent.y_min;
  double apart = 0.5;
  for (std::uint32_t tries = 0; count > 0; ++tries) {
    if (tries % 20'000 == 19'999) apart *= 0.5;
    const auto p = base::random_uniform({seed, base::RandomStream::placement, tries, 4, 0}, 0);
    const auto q = base::random_uniform({seed, base::RandomStream::placement, tries, 5, 0}, 0);
    const base::Pose pose{world.extent.x_min + p[0] * width, world.extent.y_min + p[1] * height, 0.0,
                          2.0 * M_PI * q[0] - M_PI};
    if (!is_free(world, {pose.x, pose.y}, 0.17, apart)) continue;
    add_robot(world, pose, laser);
    --count;
  }
}

}  // namespace sf::scenes
