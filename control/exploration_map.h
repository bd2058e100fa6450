#pragma once
// What an explorer knows of its surroundings: the map (maps/grid_update.h's rule), every surface point its laser met,
// and, on a lattice three times as fine as the map, how near the next surface is and whether unexplored ground is under
// a body that stands there.
//
// Clearances are to points, not to cells: exact at the lattice's nodes, but for the gaps between the beams that met a
// surface (0.1 mm for a flat one seen from near).

#include <cstdint>
#include <vector>

#include "maps/grid.h"
#include "maps/grid_update.h"

namespace sf::control {

/// Node of the lattice, row by row as the map's cells.
using Node = std::int32_t;

class ExplorationMap {
 public:
  /// @param radius [m] of the body @param reach [m] >= radius, of anything on it: it stays this far within the map
  ExplorationMap(const maps::GridGeometry& plan, double radius, double reach);

  /// Ground that no laser has to look at first, since the robot stands there.
  void mark_free(glm::dvec2 p, double radius);
  /// @return whether it told anything new
  bool add(const maps::ScanView& scan);
  /// Something was met at `p`.
  bool add_point(glm::dvec2 p);

  const maps::OccupancyGrid& grid() const { return grid_; }
  Node columns() const { return columns_; }
  Node nodes() const { return static_cast<Node>(occupied_.size()); }
  double cell() const { return cell_; }  ///< [m] of the lattice
  bool contains(glm::dvec2 p) const;
  Node node_at(glm::dvec2 p) const;  ///< Rule: contains(p)
  glm::dvec2 place(Node node) const;

  /// [m] from a node to the nearest surface point; kMaxClearance beyond the body's radius: no nearer one
  float clearance(Node node) const { return clearance_[static_cast<std::size_t>(node)]; }
  /// A body there would cover ground never seen, or leave the map.
  bool covers_unknown(Node node) const { return unknown_[static_cast<std::size_t>(node)] != 0; }
  /// A surface passes through the node's square.
  bool occupied(Node node) const { return occupied_[static_cast<std::size_t>(node)] != 0; }
  bool explored(Node node) const { return explored_[static_cast<std::size_t>(node)] != 0; }

  /// [m] from `p` to the nearest surface point, at most `most`.
  double nearest(glm::dvec2 p, double most) const;

  static constexpr double kMaxClearance = 0.06;  ///< [m]

 private:
  void mark_line(glm::dvec2 a, glm::dvec2 b);
  void explore(maps::CellAt at);
  template <typename Visit>
  void around(glm::dvec2 p, double radius, Visit visit);

  maps::OccupancyGrid grid_;
  double radius_;
  double cell_;
  Node columns_, rows_;
  std::vector<glm::dvec2> points_;
  std::vector<std::uint8_t> taken_;  ///< one bit per fine square that holds a point
  std::vector<float> clearance_;
  std::vector<std::uint16_t> unknown_;  ///< unexplored cells whose middle is under the body
  std::vector<std::uint8_t> occupied_, explored_;
  std::vector<std::uint8_t> driven_;  ///< per cell of the map
};

}  // namespace sf::control
