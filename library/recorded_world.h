#pragma once
// The recorded one of several worlds, as a simulation of it alone.

#include <cstdint>
#include <vector>

#include "base/tick_record.h"
#include "sensors/sensor_set.h"
#include "world/copies.h"
#include "world/world.h"

namespace sf::library {

class RecordedWorld {
 public:
  /// @param worlds with all movers at their starts  @param copy number of the world, below `worlds.copies`
  RecordedWorld(const world::World& worlds, std::uint32_t copy);

  const world::World& world() const { return world_; }
  const sensors::SensorSet& sensor_set() const { return sensor_set_; }
  std::uint32_t copy() const { return copy_; }
  /// Returns what belongs to this world. Valid until the next call, and as long as `all`.
  base::TickRecord part_of(const base::TickRecord& all);

 private:
  std::uint32_t copy_;
  std::uint32_t first_;  ///< row of its first mover
  world::World world_;
  sensors::SensorSet sensor_set_;
  std::vector<base::Report> reports_;
  std::vector<base::ReadingBlock> readings_;
};

}  // namespace sf::library
