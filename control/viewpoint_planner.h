#pragma once
// Viewpoints for exploration: for every lattice node, the robot headings with which a laser at that node would see an
// unexplored target cell, within field of view and range, without an obstacle or much unexplored ground in between.

#include <cstdint>
#include <functional>
#include <unordered_map>
#include <vector>

#include "control/exploration_map.h"
#include "control/pose_search.h"

namespace sf::control {

/// Parameters of the laser.
struct ScannerModel {
  base::Pose X_MS;      ///< sensor pose in the robot's frame
  double fov = M_PI;    ///< [rad]
  double range = 0.75;  ///< [m]
};

class ViewpointPlanner {
 public:
  ViewpointPlanner(const ExplorationMap& map, const ScannerModel& eye);

  /// Recomputes all viewpoints.
  /// @param all true: all unexplored cells are targets; false: only those adjacent to free cells
  /// @param range [m] maximum viewing distance
  /// @param graze occupied nodes that a line of sight may cross, since it may pass next to the surface
  /// @param claimed returns true for cells that are not targets, because another robot explores them; may be empty
  /// @return number of target cells
  std::size_t update(bool all, double range, int graze = 0, const std::function<bool(maps::CellAt)>& claimed = {});
  /// Returns the number of cells that were not targets in the last update only because they were claimed.
  std::size_t claimed() const { return claimed_; }

  /// Returns whether a laser at node `sensor` of a robot with this heading would see a target cell.
  bool sees_target(Node sensor, int heading) const {
    return (headings_[static_cast<std::size_t>(sensor)] >> heading & 1u) != 0;
  }
  /// Returns the target cells that it would see.
  std::vector<maps::CellAt> targets(Node sensor, int heading) const;

  /// Records that a cell was not seen from a viewpoint. Viewpoints near it are no longer used for this cell, and after
  /// several such records the cell is no longer a target.
  void mark_unseen(maps::CellAt cell, Node sensor);

 private:
  bool is_target(maps::CellAt cell, bool all) const;
  template <typename Visit>
  void cast(maps::CellAt cell, std::size_t ray, Visit visit) const;
  void add_target(maps::CellAt cell);

  struct Ray {
    double x, y;             ///< direction from the cell to the sensor
    std::uint16_t headings;  ///< bits of the robot headings that have the cell in view
  };
  const ExplorationMap& map_;
  std::vector<Ray> rays_;
  std::vector<std::uint16_t> headings_;  ///< per node
  std::vector<maps::CellAt> cells_;      ///< targets
  double range_ = 0.0;
  int graze_ = 0;
  std::size_t claimed_ = 0;
  std::unordered_map<std::int64_t, std::vector<Node>> unseen_from_;
};

}  // namespace sf::control
