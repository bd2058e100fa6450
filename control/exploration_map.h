#pragma once
// Map of an explorer. It contains the occupancy grid (rule of maps/grid_update.h) and all surface points that its laser
// has measured. On a lattice three times as fine as the grid it contains the clearance, and whether a body there would
// cover unexplored ground.
//
// Clearances are distances to points, not to cells. They are exact at the nodes of the lattice except for the gaps
// between the beams that hit a surface (0.1 mm for a flat surface nearby).

#include <cstdint>
#include <vector>

#include "maps/grid.h"
#include "maps/grid_update.h"

namespace sf::control {

/// Index of a lattice node, row-major like the cells of the map.
using Node = std::int32_t;

class ExplorationMap {
 public:
  /// @param radius [m] of the body
  /// @param reach [m] >= radius, to the farthest point on the body; the whole body stays within the map
  ExplorationMap(const maps::GridGeometry& geometry, double radius, double reach);

  /// Marks a disc as explored and free without a scan, because the robot occupies it.
  void mark_free(glm::dvec2 p, double radius);
  /// @return true if the scan changed the map
  bool add(const maps::ScanView& scan);
  /// Adds an obstacle point at `p`, such as a contact. @return true if it changed the map
  bool add_point(glm::dvec2 p);

  const maps::OccupancyGrid& grid() const { return grid_; }
  Node columns() const { return columns_; }
  Node nodes() const { return static_cast<Node>(occupied_.size()); }
  double cell() const { return cell_; }  ///< [m] spacing of the lattice
  bool contains(glm::dvec2 p) const;
  Node node_at(glm::dvec2 p) const;  ///< @pre contains(p)
  glm::dvec2 place(Node node) const;

  /// Returns the distance [m] from a node to the nearest surface point. Limited to the body's radius plus
  /// kMaxClearance.
  float clearance(Node node) const { return clearance_[static_cast<std::size_t>(node)]; }
  /// Returns whether a body at the node would cover unexplored ground or leave the map.
  bool covers_unknown(Node node) const { return unknown_[static_cast<std::size_t>(node)] != 0; }
  /// Returns whether a surface passes through the node's square.
  bool occupied(Node node) const { return occupied_[static_cast<std::size_t>(node)] != 0; }
  bool explored(Node node) const { return explored_[static_cast<std::size_t>(node)] != 0; }

  /// Returns the distance [m] from `p` to the nearest surface point, at most `most`.
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
  std::vector<std::uint8_t> taken_;  ///< one bit per fine square, set if the square contains a point
  std::vector<float> clearance_;
  std::vector<std::uint16_t> unknown_;  ///< number of unexplored cells whose centre is under the body
  std::vector<std::uint8_t> occupied_, explored_;
  std::vector<std::uint8_t> driven_;  ///< per cell of the map: explored
};

}  // namespace sf::control
