#pragma once
// From where a laser would see what is still unexplored: for every node of the lattice, the headings that have a wanted
// cell in their field of view, in range, with nothing known in between.

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "control/exploration_map.h"
#include "control/pose_search.h"

namespace sf::control {

/// The laser, as far as it matters here.
struct ScannerModel {
  base::Pose X_MS;      ///< in the robot's frame
  double fov = M_PI;    ///< [rad]
  double range = 0.75;  ///< [m]
};

class ViewpointPlanner {
 public:
  ViewpointPlanner(const ExplorationMap& map, const ScannerModel& eye);

  /// Looks anew. @param all every unexplored cell is wanted; else only those beside free ones @param range [m] from
  /// which they are to be seen
  /// @param graze squares with a surface in them that a line of sight may cross, since it may pass it by
  /// @return how many cells are wanted
  std::size_t update(bool all, double range, int graze = 0);

  /// Whether a sensor at `sensor` of a robot with this heading would see a wanted cell.
  bool sees_target(Node sensor, int heading) const {
    return (headings_[static_cast<std::size_t>(sensor)] >> heading & 1u) != 0;
  }
  /// The wanted cells it would see.
  std::vector<maps::CellAt> targets(Node sensor, int heading) const;

  /// It has looked from there and still does not know the cell: not from near there again, and after some such looks
  /// not at all.
  void mark_unseen(maps::CellAt cell, Node sensor);

 private:
  bool is_target(maps::CellAt cell, bool all) const;
  template <typename Visit>
  void cast(maps::CellAt cell, std::size_t ray, Visit visit) const;
  void add_target(maps::CellAt cell);
  std::int64_t key(maps::CellAt cell) const;

  struct Ray {
    double x, y;             ///< from the cell to the eye
    std::uint16_t headings;  ///< of the robot that have the cell in view
  };
  const ExplorationMap& map_;
  std::vector<Ray> rays_;
  std::vector<std::uint16_t> headings_;  ///< per node
  std::vector<maps::CellAt> cells_;      ///< wanted
  double range_ = 0.0;
  int graze_ = 0;
  std::unordered_map<std::int64_t, std::vector<Node>> unseen_from_;
};

}  // namespace sf::control
