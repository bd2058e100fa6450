#pragma once
// Reference for exploration, computed from the world: every free cell whose centre is in range and in view from a pose
// that a disc reaches without contact. Independent of the explorer except for the grid rule.

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "maps/grid.h"
#include "sensors/laser_settings.h"
#include "tests/robots/scenes.h"
#include "world/wall_tree.h"
#include "world/world.h"

namespace sf::exploration {

using base::Pose;

/// Dimensions of the reference's robot.
struct Looker {
  double radius = 0.165;  ///< [m] of the disc
  double ahead = 0.19;    ///< [m] of the sensor
  double range = 0.75;    ///< [m], half a turn to both sides
  double spare = 0.0;     ///< [m] clearance of the disc
};

inline constexpr double kStep = 0.01;  ///< [m] between tested poses
inline constexpr int kTurns = 48;      ///< headings per pose

/// All poses in the map's rectangle, on a lattice of kStep.
class Reference {
 public:
  Reference(const world::World& world, const maps::GridGeometry& geometry, glm::dvec2 start, const Looker& looker)
      : world_(world), geometry_(geometry), looker_(looker) {
    wide_ = static_cast<int>(std::lround(static_cast<double>(maps::columns(geometry)) * geometry.cell / kStep));
    high_ = static_cast<int>(std::lround(static_cast<double>(maps::rows(geometry)) * geometry.cell / kStep));
    reach(start);
    look_from_everywhere();
    flood(start);
  }

  /// Returns one value per cell, row by row: 1 if the cell is visible.
  std::vector<std::uint8_t> seen() const {
    std::vector<std::uint8_t> seen(connected_.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const auto at = static_cast<std::int64_t>(i);
      const maps::CellAt cell{at % maps::columns(geometry_), at / maps::columns(geometry_)};
      if (connected_[i] != 0) seen[i] = in_view(maps::middle(geometry_, cell)) ? 1 : 0;
    }
    return seen;
  }

 private:
  glm::dvec2 place(int column, int row) const {
    return {geometry_.left + (column + 0.5) * kStep, geometry_.top - (row + 0.5) * kStep};
  }
  bool clear(glm::dvec2 p) const {
    for (const auto& wall : world_.walls)
      if (wall.z_min < 0.1 && world::distance(p, wall.a, wall.b) < looker_.radius + looker_.spare) return false;
    return true;
  }
  bool hidden(glm::dvec2 p, glm::dvec2 q) const {
    for (const auto& wall : world_.walls)
      if (wall.z_min <= 0.17 && wall.z_max > 0.17 && world::segments_meet(p, q, wall.a, wall.b)) return true;
    return false;
  }

  // Finds positions of the disc that are connected to the start.
  void reach(glm::dvec2 start) {
    reached_.resize(static_cast<std::size_t>(wide_ * high_));
    std::vector<int> open{static_cast<int>((geometry_.top - start.y) / kStep) * wide_ +
                          static_cast<int>((start.x - geometry_.left) / kStep)};
    reached_[static_cast<std::size_t>(open[0])] = 1;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (int k = 0; k < 9; ++k) {
        const int column = at % wide_ + k % 3 - 1, row = at / wide_ + k / 3 - 1;
        if (column < 0 || row < 0 || column >= wide_ || row >= high_) continue;
        auto& reached = reached_[static_cast<std::size_t>(row * wide_ + column)];
        if (reached != 0 || !clear(place(column, row))) continue;
        reached = 1;
        open.push_back(row * wide_ + column);
      }
    }
  }

  // Finds positions of the sensor, with the headings that lead to them.
  void look_from_everywhere() {
    headings_.resize(reached_.size());
    for (int at = 0; at < wide_ * high_; ++at) {
      if (reached_[static_cast<std::size_t>(at)] == 0) continue;
      const glm::dvec2 p = place(at % wide_, at / wide_);
      for (int k = 0; k < kTurns; ++k) {
        const double yaw = 2.0 * M_PI * k / kTurns;
        const glm::dvec2 s = p + looker_.ahead * glm::dvec2{std::cos(yaw), std::sin(yaw)};
        const int column = static_cast<int>((s.x - geometry_.left) / kStep),
                  row = static_cast<int>((geometry_.top - s.y) / kStep);
        if (column < 0 || row < 0 || column >= wide_ || row >= high_) continue;
        auto& headings = headings_[static_cast<std::size_t>(row * wide_ + column)];
        if ((headings >> k & 1u) == 0 && !hidden(p, place(column, row))) headings |= std::uint64_t{1} << k;
      }
    }
  }

  // Finds the cells that a point reaches from the start.
  void flood(glm::dvec2 start) {
    connected_.resize(static_cast<std::size_t>(maps::columns(geometry_) * maps::rows(geometry_)));
    std::vector<maps::CellAt> open{maps::cell_at(geometry_, start)};
    while (!open.empty()) {
      const maps::CellAt at = open.back();
      open.pop_back();
      for (std::int64_t k = 0; k < 9; ++k) {
        const maps::CellAt next{at.column + k % 3 - 1, at.row + k / 3 - 1};
        if (!maps::contains(geometry_, next)) continue;
        auto& connected = connected_[static_cast<std::size_t>(next.row * maps::columns(geometry_) + next.column)];
        if (connected != 0 || hidden(maps::middle(geometry_, at), maps::middle(geometry_, next))) continue;
        connected = 1;
        open.push_back(next);
      }
    }
  }

  bool in_view(glm::dvec2 m) const {
    const int reach = static_cast<int>(looker_.range / kStep) + 1;
    const int column = static_cast<int>((m.x - geometry_.left) / kStep),
              row = static_cast<int>((geometry_.top - m.y) / kStep);
    for (int r = std::max(0, row - reach); r < std::min(high_, row + reach + 1); ++r) {
      for (int c = std::max(0, column - reach); c < std::min(wide_, column + reach + 1); ++c) {
        const std::uint64_t headings = headings_[static_cast<std::size_t>(r * wide_ + c)];
        if (headings == 0) continue;
        const glm::dvec2 s = place(c, r), d = m - s;
        if (glm::dot(d, d) > looker_.range * looker_.range) continue;
        if (faces(headings, d) && !hidden(s, m)) return true;
      }
    }
    return false;
  }
  static bool faces(std::uint64_t headings, glm::dvec2 d) {
    for (int k = 0; k < kTurns; ++k) {
      const double yaw = 2.0 * M_PI * k / kTurns;
      if ((headings >> k & 1u) != 0 && glm::dot(d, {std::cos(yaw), std::sin(yaw)}) >= 0.0) return true;
    }
    return false;
  }

  const world::World& world_;
  maps::GridGeometry geometry_;
  Looker looker_;
  int wide_ = 0, high_ = 0;
  std::vector<std::uint8_t> reached_;
  std::vector<std::uint64_t> headings_;
  std::vector<std::uint8_t> connected_;
};

/// A square of 3 m with boxes of 0.2 to 0.6 m at any angle, and a Create with the thesis' laser at a free place.
inline world::World boxes(std::uint64_t seed, int count) {
  world::World world = scenes::boxed_world(3.0, 3.0, {-1.5, -1.5});
  const auto draw = [&](std::uint32_t i, std::uint32_t k) {
    return base::random_uniform({.seed = seed, .a = i, .b = k}, 0);
  };
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    const auto place = draw(i, 0), size = draw(i, 1), turn = draw(i, 2);
    const glm::dvec2 centre{3.0 * place[0] - 1.5, 3.0 * place[1] - 1.5};
    std::vector<glm::dvec2> corners = scenes::rectangle({}, 0.2 + 0.4 * size[0], 0.2 + 0.4 * size[1]);
    for (glm::dvec2& corner : corners) corner = centre + base::rotate(2.0 * M_PI * turn[0], corner);
    scenes::add_outline(world.walls, corners);
  }
  for (std::uint32_t i = 1000; world.movers.empty(); ++i) {
    const auto place = draw(i, 0);
    const glm::dvec2 p{3.0 * place[0] - 1.5, 3.0 * place[1] - 1.5};
    bool free = std::abs(p.x) < 1.25 && std::abs(p.y) < 1.25;
    for (const auto& wall : world.walls) free = free && world::distance(p, wall.a, wall.b) > 0.24;
    int crossings = 0;
    for (const auto& wall : world.walls) crossings += world::segments_meet(p, {p.x + 9.0, p.y + 1e-3}, wall.a, wall.b);
    if (!free || crossings % 2 == 0) continue;
    world::Mover& create = scenes::add_create(world, {p.x, p.y, 0.0, 2.0 * M_PI * place[0]});
    sensors::LaserSettings laser;
    laser.X_MS = {0.19, 0.0, 0.17, 0.0};
    laser.fov = M_PI;
    laser.samples = 361;
    laser.range_max = 0.75;
    laser.rate = 13.0;
    create.sensors.push_back(sensors::laser_sensor(laser));
  }
  world.extent = {-1.5, -1.5, 1.5, 1.5};
  return world;
}

}  // namespace sf::exploration
