#pragma once
// Occupancy grids of the experiment `tree`: one from each choice of the car's range sensors, against the true map.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/tick_record.h"
#include "sensors/occupancy.h"

namespace sf::scenarios {

/// The range sensors: the first rows of kTreeSensors. Tags say nothing about cells.
inline constexpr std::size_t kGridSensors = 4;
inline constexpr unsigned kAllGridSensors = (1u << kGridSensors) - 1;

/// Poses by which readings are added to a grid.
enum class GridPose : std::uint8_t { exact, own };

/// A grid against what an exact scan would have seen from the car's path: surfaces, and the free cells before them.
struct TreeGrid {
  unsigned sensors = 0;  ///< bit k: sensor k is on
  GridPose pose = GridPose::exact;
  std::size_t surfaces = 0, found = 0;  ///< cells with a surface; of these, a neighbour or the cell is occupied
  std::size_t occupied = 0, right = 0, exact = 0;  ///< cells taken for occupied; near a surface; on one
  std::size_t free = 0, wrong = 0;                 ///< cells taken for free; of these, on a surface
  std::size_t cells = 0, explored = 0;             ///< seen by the exact scan; of these, not unexplored
  double log_loss = 0.0, squares = 0.0;            ///< sums over `cells`, by the probability of each

  void add(const TreeGrid& other);
};

class TreeGrids {
 public:
  /// @param map settings of the car's map @throws base::InputError unless the car has the sensors of the experiment
  TreeGrids(const world::World& world, const sensors::Occupancy& map);

  /// Adds the car's readings.
  void add(const base::TickRecord& tick);
  /// Adds what an exact scan sees at the car's pose.
  void look(const base::TickRecord& tick);
  /// Compares all grids with the truth, without the cells near other robots: those of each pose in order of `sensors`,
  /// from 1.
  std::vector<TreeGrid> compare(const base::TickRecord& tick) const;
  const maps::LogOddsGrid& grid(unsigned sensors, GridPose pose) const {
    return grids_[static_cast<std::size_t>(pose)][sensors - 1];
  }

 private:
  enum class Truth : std::uint8_t { unseen, free, surface };
  void cast(const base::Pose& X_WM, double bearing);
  std::vector<Truth> truth_now(const base::TickRecord& tick) const;
  bool near_surface(const std::vector<Truth>& truth, maps::CellAt at) const;
  std::size_t index_of(maps::CellAt at) const {
    return static_cast<std::size_t>(at.row * maps::columns(geometry_) + at.column);
  }

  const world::World& world_;
  std::uint32_t car_;
  maps::GridGeometry geometry_;
  std::array<std::vector<sensors::RangeSource>, 2> sources_;  ///< per pose
  std::array<std::vector<maps::LogOddsGrid>, 2> grids_;       ///< per pose
  maps::RangeEvidence evidence_;
  std::vector<Truth> truth_;  ///< row by row
};

}  // namespace sf::scenarios
