#pragma once
// The unchanging tables of a DeviceFleet.

#include <cstdint>
#include <vector>

#include "robots/device/device_tables.h"
#include "robots/fleet_rules.h"
#include "robots/footprint.h"
#include "world/world.h"

namespace sf::robots {

/// Each table has at least one record, since devices have no empty tables.
struct FleetTables {
  std::vector<FleetDrive> drives;          ///< per mover
  std::vector<FleetBody> bodies;           ///< per mover
  std::vector<FleetFootprint> footprints;  ///< different ones
  std::vector<FleetEdge> edges;
  WallTables walls;                  ///< that stop robots
  std::vector<FleetBorder> borders;  ///< between contact sectors; the last one is the first
};

/// Bounds of what a mover may do in a second, with a margin for rounding.
struct MotionBound {
  double speed;   ///< [m/s] of its origin
  double turn;    ///< [rad/s]
  double radius;  ///< [m] of its outline
  double step;    ///< [m] Footprint::step

  /// Returns a bound of the substeps of a tick.
  double steps(double seconds) const { return (speed + radius * turn) * seconds / step; }
  /// Returns a bound of the travel [m] of its origin, with a push-off per substep.
  double travel(double seconds) const { return speed * seconds + kMaxYield * (steps(seconds) + 6.0); }
  auto operator<=>(const MotionBound&) const = default;
};
MotionBound motion_bound(const world::Mover& mover);

FleetTables fleet_tables(const world::World& world);

}  // namespace sf::robots
