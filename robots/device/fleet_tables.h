#pragma once
// The unchanging tables of a DeviceFleet.

#include <cstdint>
#include <vector>

#include "robots/device/records.h"
#include "robots/footprint.h"
#include "world/world.h"

namespace sf::robots {

/// Each table has at least one record, since devices have no empty tables.
struct FleetTables {
  std::vector<FleetDrive> drives;          ///< per mover
  std::vector<FleetBody> bodies;           ///< per mover
  std::vector<FleetFootprint> footprints;  ///< different ones
  std::vector<FleetEdge> edges;
  std::vector<FleetWall> walls;  ///< that stop robots, in the order of the tree's leaves
  std::vector<FleetNode> nodes;
  std::vector<FleetBorder> borders;  ///< between contact sectors; the last one is the first
  std::uint32_t node_count = 0;
};

FleetTables fleet_tables(const world::World& world);

}  // namespace sf::robots
