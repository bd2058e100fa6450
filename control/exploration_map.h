#pragma once
// Map of an explorer. It contains the occupancy grid (rule of maps/grid_update.h) and all surface points that its laser
// has measured. On a lattice three times as fine as the grid it contains the clearance, and whether a body there would
// cover unexplored ground.
//
// Clearances are distances to points, not to cells. They are exact at the nodes of the lattice except for the gaps
// between the beams that hit a surface (0.1 mm for a flat surface nearby).
//
// In a moving world, cells have log odds: a cell that is seen free often enough becomes free and loses its points.

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "control/shared_map.h"
#include "maps/grid.h"
#include "maps/grid_update.h"

namespace sf::control {

/// Index of a lattice node, row-major like the cells of the map.
using Node = std::int32_t;

/// Resolution of the clearances, and whether objects of the world move.
struct ExplorationMapSettings {
  double most_clearance = 0.06;  ///< [m] beyond the body's radius up to which clearances are kept
  bool moving = false;           ///< objects move: cells may become free again
};

class ExplorationMap {
 public:
  /// @param radius [m] of the body
  /// @param reach [m] >= radius, to the farthest point on the body; the whole body stays within the map
  ExplorationMap(const maps::GridGeometry& geometry, double radius, double reach,
                 const ExplorationMapSettings& settings = {});

  /// Marks a disc as explored and free without a scan, because the robot occupies it.
  void mark_free(glm::dvec2 p, double radius);
  /// @return true if the scan changed the map
  bool add(const maps::ScanView& scan);
  /// Adds an obstacle point at `p`, such as a contact. @return true if it changed the map
  bool add_point(glm::dvec2 p);

  /// Records own measurements for `take_changes` from now on.
  void record_changes() { recording_ = true; }
  /// Returns the measurements since the last call. Merged ones are not included.
  MapChanges take_changes() { return std::exchange(changes_, {}); }
  /// Merges measurements of another robot. Cells that differ become occupied, and the order of merges does not matter;
  /// in a moving world the last measurement counts.
  /// @param changes on the same geometry @return true if they changed the map
  bool merge(const MapChanges& changes);
  /// Sets the places of other robots' bodies, which the own body must not approach. Replaces those of the last call.
  /// @param distances [m] between the centres, one per place
  void set_bodies(std::span<const glm::dvec2> places, std::span<const double> distances);

  /// Brings clearances up to date after cells became free. Until then they are too small there.
  void refresh();

  const maps::OccupancyGrid& grid() const { return grid_; }
  /// Returns the index of a cell, row by row.
  std::int64_t key(maps::CellAt cell) const { return cell.row * maps::columns(grid_.geometry) + cell.column; }
  Node columns() const { return columns_; }
  Node nodes() const { return static_cast<Node>(occupied_.size()); }
  double cell() const { return cell_; }  ///< [m] spacing of the lattice
  bool contains(glm::dvec2 p) const;
  /// Returns whether a body at `p` is within the map, with the reach of its parts and some nodes around it.
  bool surrounds(glm::dvec2 p) const;
  Node node_at(glm::dvec2 p) const;  ///< @pre contains(p)
  glm::dvec2 place(Node node) const;

  /// Returns the distance [m] from a node to the nearest surface point. Limited to the body's radius plus
  /// `most_clearance`.
  float clearance(Node node) const { return clearance_[static_cast<std::size_t>(node)]; }
  /// Returns whether a body at the node would cover unexplored ground, leave the map or be too close to another robot.
  bool covers_unknown(Node node) const { return unknown_[static_cast<std::size_t>(node)] != 0; }
  /// Returns whether a surface passes through the node's square.
  bool occupied(Node node) const { return occupied_[static_cast<std::size_t>(node)] != 0; }
  bool explored(Node node) const { return explored_[static_cast<std::size_t>(node)] != 0; }

  /// Returns the distance [m] from `p` to the nearest surface point, at most `most`.
  double nearest(glm::dvec2 p, double most) const;

 private:
  std::size_t bit_of(glm::dvec2 p) const;
  std::size_t key_at(glm::dvec2 p) const;
  bool may_be_surface(glm::dvec2 p) const;
  void lower_clearance(glm::dvec2 p);
  void mark_occupied(glm::dvec2 p);
  void forget(maps::CellAt cell);
  void merge_cell(maps::CellAt at, maps::Cell state);
  bool compare_words(const std::vector<std::uint32_t>& before);
  void count_unknown(maps::CellAt cell, int by);
  void explore_cell(maps::CellAt cell);
  void mark_line(glm::dvec2 a, glm::dvec2 b);
  void explore(maps::CellAt at);
  template <typename Visit>
  void around(glm::dvec2 p, double radius, Visit visit);

  maps::OccupancyGrid grid_;
  std::optional<maps::LogOddsGrid> odds_;  ///< nullopt: a static world
  double radius_, most_clearance_;
  std::size_t finer_;  ///< fine squares per side of a node's square; each keeps one point
  double cell_;
  Node columns_, rows_;
  Node rim_ = 0;                 ///< nodes at the border that count as unknown
  std::vector<Node> half_rows_;  ///< nodes under a body in the middle of a cell: half widths of rows, middle row first
  std::vector<std::vector<glm::dvec2>> points_;  ///< per cell of the map
  bool stale_ = false;                           ///< points were removed since `refresh`
  std::vector<std::uint8_t> taken_;              ///< one bit per fine square, set if the square contains a point
  std::vector<float> clearance_;
  std::vector<std::uint16_t> unknown_;  ///< number of unexplored cells whose centre is under the body, and of other
                                        ///< robots that it would be too close to
  std::vector<std::uint8_t> occupied_, explored_;
  std::vector<std::uint8_t> driven_;  ///< per cell of the map: explored
  bool recording_ = false;
  MapChanges changes_;               ///< since the last `take_changes`
  std::vector<std::size_t> bodies_;  ///< nodes counted in `unknown_` for other robots
};

}  // namespace sf::control
