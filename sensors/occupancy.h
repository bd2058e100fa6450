#pragma once
// Occupancy maps: what a robot's laser has told of the ground so far (docs/maps.md).
//
// In a world file, inside a robot:
//   occupancy( cell 0.03  words [30 30]  offset [ox oy]  laser "name"  rate 1  log_odds 0 )
// A sensor without a body, made of the readings of one of its robot's lasers: every scan of it is entered, by the rule
// of maps/grid_update.h, from where the robot believes to be. `offset` is the thesis' (O_x, O_y): the map begins at
// x = -ox and y = -oy and goes along +x and -y; without one, its middle is where the robot stood when the world was
// loaded, to the cell. `log_odds` weighs scans: 1, or [hit miss limit] in whole numbers; with 0 the last scan is right.
//
// A reading is the map as packed words (maps/grid.h), row by row. Its X_WS is the map's upper left corner, with no
// yaw. Its `flags` are maps::kTruePoses or 0. The map grows while the robot's laser is heard, whoever hears the map.

#include <cstdint>
#include <vector>

#include "sensors/occupancy_batch.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kOccupancy = 12;  ///< wire id

/// What a world file says of one map.
struct Occupancy {
  SensorSpec row;
  MapPlan plan;
  std::uint32_t laser = 0;  ///< number of the mover's laser that fills it
};

/// All maps, by mover and in file order. @throws base::InputError with file and line.
std::vector<Occupancy> occupancies_of(const world::World& world);

extern const SensorType occupancy_type;

}  // namespace sf::sensors
