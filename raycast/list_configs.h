#pragma once
// List configs: groups of sensors that can share lists, with an index of the walls visible to them. Used by the casters
// on the host and on the device.

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "raycast/wall_index.h"
#include "world/world.h"

namespace sf::raycast {

/// Sensors of equal height and range, which can share lists. The other fields are maxima over these sensors.
struct ListConfig {
  double z = 0.0;             ///< [m] world height of the sensors
  double range = 0.0;         ///< [m]
  double spread = 0.0;        ///< [rad] from the middle of a lane's beams to the outermost
  double fov = 0.0;           ///< [rad] including the largest angular noise
  std::uint32_t beams = 361;  ///< beams per robot and tick; more beams make smaller cells worthwhile
};

/// `world` may be destroyed after construction.
class ListConfigs {
 public:
  explicit ListConfigs(const world::World& world);

  /// Adds a config and returns its index. Configs of equal height and range are merged.
  std::uint32_t add(const ListConfig& config);

  std::size_t size() const { return rows_.size(); }
  const ListConfig& operator[](std::size_t i) const { return rows_[i].config; }
  /// Returns the walls visible to config `i`. Configs between the same two height breaks share one index.
  const WallIndex& wall_index(std::size_t i) const { return *rows_[i].wall_index; }
  /// Returns the walls of the world, with the rows of `World::walls`.
  const std::vector<world::Segment>& walls() const { return walls_; }

 private:
  struct Row {
    ListConfig config;
    const WallIndex* wall_index;
  };
  std::vector<world::Segment> walls_;
  std::vector<double> breaks_;  ///< [m] ascending heights at which the set of visible walls changes
  std::map<std::size_t, std::unique_ptr<WallIndex>> wall_indices_;  ///< keyed by the interval between breaks
  std::vector<Row> rows_;
};

}  // namespace sf::raycast
