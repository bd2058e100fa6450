#pragma once
// List configs: groups of sensors that can share lists, and the index of all walls. Used by the casters on the host and
// on the device.

#include <cstdint>
#include <vector>

#include "raycast/wall_index.h"
#include "world/world.h"

namespace sf::raycast {

/// Sensors of equal height at load and equal range. They share the lists of walls at each height. The other fields are
/// maxima over these sensors.
struct ListConfig {
  double z = 0.0;             ///< [m] world height of the sensors at load
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
  const ListConfig& operator[](std::size_t i) const { return rows_[i]; }
  const WallIndex& wall_index() const { return wall_index_; }
  /// Returns the number of the interval of heights that contains `z` [m]. In an interval, the visible walls are the
  /// same.
  std::uint32_t level_of(double z) const;
  /// Returns the lower end [m] of an interval of heights, which belongs to it; -infinity for the lowest.
  double z_of(std::int64_t level) const;
  /// Returns the walls of the world, with the rows of `World::walls`.
  const std::vector<world::Segment>& walls() const { return walls_; }

 private:
  std::vector<world::Segment> walls_;
  std::vector<double> breaks_;  ///< [m] ascending heights at which the set of visible walls changes
  WallIndex wall_index_;
  std::vector<ListConfig> rows_;
};

}  // namespace sf::raycast
