#pragma once
// Occupancy grid maps from a robot's laser, or from several range sensors of any robots (docs/maps.md).
//
// In a world file, inside a robot:
//   occupancy( cell 0.03  words [30 30]  offset [ox oy]  laser "name"  rate 1  log_odds 0 )
//   occupancy( sources ["laser" "sonar" "scout/laser:1" "*/infrared"] ... )
// This is a derived sensor without a body. Every scan of one of its robot's lasers is added to the map, by the rule of
// maps/grid_update.h, from the robot's estimated pose. `offset` is the thesis' (O_x, O_y): the map begins at x = -ox
// and y = -oy and extends along +x and -y. Without it, the map's centre is the robot's position at load, rounded to
// cells. `log_odds` selects the update: 1, or [hit miss limit] in integers; 0: the last scan overwrites.
//
// `sources`: lasers, sonars and infrareds, "[robot/]type[:number]" each, "*" for every robot that has one. Their
// readings are added by the rule of maps/range_evidence.h, always with log odds.
//
// A reading is the map as packed words (maps/grid.h), row by row. Its X_WS is the map's upper left corner, with yaw 0.
// Its `flags` are maps::kTruePoses or 0. The map is updated while its laser or sources are subscribed, even if the map
// is not.

#include <cstdint>
#include <vector>

#include "sensors/occupancy_batch.h"
#include "sensors/range_source.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kOccupancy = 12;  ///< wire id

/// Settings of one map.
struct Occupancy {
  SensorSpec row;
  MapSettings settings;
  std::uint32_t laser = 0;           ///< index of the mover's laser that fills it, if it has no `sources`
  std::vector<RangeSensor> sources;  ///< ascending
};

/// Returns all maps, by mover and in file order. @throws base::InputError with file and line
std::vector<Occupancy> occupancies_of(const world::World& world);

/// @param maps all of the world, by mover and in file order
/// @throws base::InputError if a map has sources of other robots, whose readings other processes may have
void require_own_sources(const world::World& world, std::span<const Occupancy> maps);

extern const SensorType occupancy_type;

}  // namespace sf::sensors
