#pragma once
// Visibility from many poses of a laser: whether a point is visible from any of them.
//
// Poses are the centres of cells with sixteen headings each. Testing all of them by ray casts would take millions of
// rays for a hidden point. The search is therefore reversed: it sweeps the walls by angle around the point, which
// bounds the visible area by one triangle per pair of neighbouring directions, and casts rays only to the poses in
// these triangles. A triangle ends at one of the walls that cover it, so it may be too large but never too small:
// results equal those of all rays. Walls are collected from growing squares, so a point within an obstacle costs only
// the walls of that obstacle.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "maps/grid.h"
#include "sensors/sensor_type.h"
#include "world/wall_tree.h"

namespace sf::scenarios {

class Sight {
 public:
  static constexpr int kHeadings = 16;

  /// @param walls visible to the laser @param robots cells whose centres the robot's origin can reach: the free ones
  Sight(std::vector<world::Segment> walls, const sensors::SensorSpec& laser, const maps::OccupancyGrid& robots);

  /// Returns whether the point is visible from the centre of the cell with any of the headings: in range and field of
  /// view, with no wall in front of it. A wall through the point does not hide it. Poses with the laser inside a wall
  /// do not count.
  bool sees(maps::CellAt robot, glm::dvec2 p) const;
  /// Returns a cell from which the point is visible; nullopt: none.
  std::optional<maps::CellAt> find(glm::dvec2 p);

  const world::WallTree& walls() const { return walls_; }

 private:
  struct Edge {
    glm::dvec2 a, b;  ///< [m] from the point, counter-clockwise
    double first;     ///< covers pseudo-angles [first, last]
    double last;
    bool is_wall;  ///< false: a side of the square
  };
  struct Direction {
    double angle;
    glm::dvec2 d;
  };
  struct Heading {
    glm::dvec2 eye;        ///< [m] from the robot's origin
    double yaw;            ///< [rad]
    maps::CellAt cells{};  ///< offset from the robot's cell to that of the eye
  };

  bool sees(maps::CellAt robot, const Heading& heading, glm::dvec2 p) const;
  bool is_clear(glm::dvec2 from, glm::dvec2 to) const;
  bool is_robot(maps::CellAt at) const {
    return maps::contains(robots_.geometry, at) && robots_.at(at) == maps::Cell::free;
  }
  /// Index of the count of eyes before a cell, in the grid or the margin around it.
  std::size_t place_of(maps::CellAt eye) const {
    const std::int64_t wide = maps::columns(robots_.geometry) + 2 * margin_ + 1;
    return static_cast<std::size_t>((eye.row + margin_) * wide + eye.column + margin_);
  }
  void count_eyes();
  void add_edge(glm::dvec2 a, glm::dvec2 b, bool is_wall);
  void gather(glm::dvec2 p, double size);
  bool may_reach_eyes(glm::dvec2 p, glm::dvec2 d0, glm::dvec2 d1) const;
  std::optional<maps::CellAt> find_within(glm::dvec2 p, double size, bool& open);
  std::optional<maps::CellAt> find_in_triangle(glm::dvec2 p, glm::dvec2 q0, glm::dvec2 q1) const;

  world::WallTree walls_;
  sensors::SensorSpec laser_;
  const maps::OccupancyGrid& robots_;
  std::array<Heading, kHeadings> headings_;
  std::int64_t margin_;              ///< cells around the grid that may contain eyes of its robots
  std::vector<std::uint32_t> eyes_;  ///< number of cells with an eye before each cell of a row, and in the whole row
  base::Box box_;                    ///< of all eyes
  std::vector<Edge> edges_;          ///< scratch for one search, as all below
  std::vector<Direction> directions_;
  std::vector<const Edge*> active_;
};

}  // namespace sf::scenarios
