#pragma once
// Occupancy maps with `sources`, on the host: several range sensors fill one map.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "sensors/occupancy.h"

namespace sf::sensors {

/// Not thread-safe. Results do not depend on the order of readings in a call, nor on the number of threads.
class SourceMaps {
 public:
  /// Keeps those of `maps` that have sources, by their rows. @param thread_pool must outlive it
  SourceMaps(const world::World& world, std::span<const Occupancy> maps, base::ThreadPool& thread_pool);

  /// Adds the readings of one tick, by their robots' poses, in order of type, robot and number.
  void observe(std::span<const base::ReadingBlock> readings);
  /// Returns the words of a map. Valid until the next call of `observe`. @pre the map has sources
  std::span<const std::uint32_t> words(std::uint32_t map) const { return maps_[map]->grid.words; }
  /// Makes a map unexplored. @pre the map has sources
  void restart(const world::World& world, std::uint32_t map);
  /// Continues the first `rows` maps of `before`, which must not be used afterwards.
  void take_over(SourceMaps& before, std::uint32_t rows);

 private:
  struct Map {
    maps::LogOddsGrid grid;
    std::vector<RangeSource> sources;
  };
  void add_readings(Map& map, maps::RangeEvidence& evidence) const;

  base::ThreadPool& thread_pool_;
  std::vector<std::unique_ptr<Map>> maps_;     ///< null: without sources
  std::vector<maps::RangeEvidence> evidence_;  ///< per thread
  bool any_ = false;
  std::vector<const base::ReadingBlock*> readings_;  ///< of range sensors, ascending
};

}  // namespace sf::sensors
