#pragma once
// Sensors that can share lists, and the walls that each of them sees: indexed once, for both casters.

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "raycast/sight.h"
#include "world/world.h"

namespace sf::raycast {

/// Sensors that can share lists: one height, one range.
struct Family {
  double z = 0.0;             ///< [m] world height of the sensors
  double range = 0.0;         ///< [m]
  double spread = 0.0;        ///< [rad] from the middle of a lane's beams to its outermost: largest of its sensors
  double fov = 0.0;           ///< [rad] largest of its sensors, with all that noise may add
  std::uint32_t beams = 361;  ///< that one robot casts in a tick: many are worth small cells
};

/// `world` need not outlive it.
class Families {
 public:
  explicit Families(const world::World& world);

  /// Equal height and range give the same number.
  std::uint32_t add(const Family& family);

  std::size_t size() const { return rows_.size(); }
  const Family& operator[](std::size_t i) const { return rows_[i].family; }
  /// The walls that family `i` sees; families between the same two breaks of height share them.
  const Sight& sight(std::size_t i) const { return *rows_[i].sight; }
  /// Of the world, row by row.
  const std::vector<world::Segment>& walls() const { return walls_; }

 private:
  struct Row {
    Family family;
    const Sight* sight;
  };
  std::vector<world::Segment> walls_;
  std::vector<double> breaks_;                            ///< [m] heights at which the set of visible walls changes
  std::map<std::size_t, std::unique_ptr<Sight>> sights_;  ///< by the interval between breaks
  std::vector<Row> rows_;
};

}  // namespace sf::raycast
