#pragma once
// List configs: sensors that can share lists, with the index of the walls visible to them. Shared by both casters.

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "raycast/wall_index.h"
#include "world/world.h"

namespace sf::raycast {

/// Sensors that can share lists: equal height and range. The other fields are maxima over these sensors.
struct ListConfig {
  double z = 0.0;             ///< [m] world height of the sensors
  double range = 0.0;         ///< [m]
  double spread = 0.0;        ///< [rad] from the middle of a lane's beams to its outermost
  double fov = 0.0;           ///< [rad] including the largest angular noise
  std::uint32_t beams = 361;  ///< beams per robot and tick; more beams make smaller cells worthwhile
};

/// `world` need not outlive it.
class ListConfigs {
 public:
  explicit ListConfigs(const world::World& world);

  /// Returns the index of the config. Configs of equal height and range are merged.
  std::uint32_t add(const ListConfig& config);

  std::size_t size() const { return rows_.size(); }
  const ListConfig& operator[](std::size_t i) const { return rows_[i].config; }
  /// The walls visible to config `i`. Configs between the same two height breaks share one index.
  const WallIndex& wall_index(std::size_t i) const { return *rows_[i].wall_index; }
  /// Walls of the world; same rows as `World::walls`.
  const std::vector<world::Segment>& walls() const { return walls_; }

 private:
  struct Row {
    ListConfig config;
    const WallIndex* wall_index;
  };
  std::vector<world::Segment> walls_;
  std::vector<double> breaks_;  ///< [m] ascending heights at which the set of visible walls changes
  std::map<std::size_t, std::unique_ptr<WallIndex>> wall_indices_;  ///< by the interval between breaks
  std::vector<Row> rows_;
};

}  // namespace sf::raycast
