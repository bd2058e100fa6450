#pragma once
// Sensors that can share lists, and the walls that each of them sees: indexed once, for both casters.

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "raycast/wall_index.h"
#include "world/world.h"

namespace sf::raycast {

/// Sensors that can share lists: one height, one range.
struct ListConfig {
  double z = 0.0;             ///< [m] world height of the sensors
  double range = 0.0;         ///< [m]
  double spread = 0.0;        ///< [rad] from the middle of a lane's beams to its outermost: largest of its sensors
  double fov = 0.0;           ///< [rad] largest of its sensors, with all that noise may add
  std::uint32_t beams = 361;  ///< that one robot casts in a tick: many are worth small cells
};

/// `world` need not outlive it.
class ListConfigs {
 public:
  explicit ListConfigs(const world::World& world);

  /// Equal height and range give the same number.
  std::uint32_t add(const ListConfig& config);

  std::size_t size() const { return rows_.size(); }
  const ListConfig& operator[](std::size_t i) const { return rows_[i].config; }
  /// The walls that family `i` sees; families between the same two breaks of height share them.
  const WallIndex& wall_index(std::size_t i) const { return *rows_[i].wall_index; }
  /// Of the world, row by row.
  const std::vector<world::Segment>& walls() const { return walls_; }

 private:
  struct Row {
    ListConfig config;
    const WallIndex* wall_index;
  };
  std::vector<world::Segment> walls_;
  std::vector<double> breaks_;  ///< [m] heights at which the set of visible walls changes
  std::map<std::size_t, std::unique_ptr<WallIndex>> wall_indices_;  ///< by the interval between breaks
  std::vector<Row> rows_;
};

}  // namespace sf::raycast
