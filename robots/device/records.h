#ifndef ROBOTS_DEVICE_RECORDS_H
#define ROBOTS_DEVICE_RECORDS_H
// Records of a fleet's motion, shared by host and device (robots/device/device_fleet.h). cmake/records.awk generates
// the kernels' accessors from the structs.

#define SF_FLEET_ROUNDS 4u           // robots::Fleet::kRounds
#define SF_FLEET_DONE 10u            // FleetOwn::phase after a tick
#define SF_FLEET_FAILED 0xFFFFFFFFu  // FleetOwn::phase: the mover needed more turns of loops than the device allows

// Fields of FleetBody: world::Drive and world::ActuatorModel.
#define SF_DRIVE_CAR 0u
#define SF_DRIVE_OMNI 1u
#define SF_DRIVE_OTHER 2u

// Rounds of a mover, FleetOwn::round.
#define SF_ROUND_OUT 0u
#define SF_ROUND_IN 1u
#define SF_ROUND_YIELDED 2u

#ifdef __cplusplus

#include <cstdint>

namespace sf::robots {

/// One tick.
struct FleetTick {
  double seconds, cell;       ///< [s] > 0, [m] > 0 of the grid of movers
  double widest, farthest;    ///< [m] largest outline radius, and bound of all travels
  std::uint32_t movers;       ///< number of rows
  std::uint32_t copy_movers;  ///< rows per copy of the world
  std::uint32_t nodes;        ///< of the tree of walls
  std::uint32_t buckets;      ///< of the grid, a power of two
};

/// A mover in the grid, at its position at the start of the tick.
struct FleetPlace {
  std::int32_t x, y;   ///< cell
  std::uint32_t copy;  ///< of the world
  std::uint32_t next;  ///< 1 + the row of the next mover in the bucket; 0: none
};

/// A commanded twist.
struct FleetCommand {
  double forward, left;
  double turn, spare;
};

/// Limits of a mover's drive.
struct FleetDrive {
  double max_forward, max_turn;
  double steer_tangent, wheelbase;
  double track, max_acceleration;
  double max_turn_acceleration, grip;
  double acceleration, spare;  ///< [-] factor of the accelerations
};

/// Constants of a mover that kernels of other movers read, too.
struct FleetBody {
  std::uint32_t footprint;  ///< row
  std::uint32_t rank;       ///< place in the order of ids, robots before tags
  std::uint32_t drive;      ///< SF_DRIVE_CAR, SF_DRIVE_OMNI or SF_DRIVE_OTHER
  std::uint32_t create;     ///< 1: world::ActuatorModel::player_create
};

/// robots::Footprint.
struct FleetFootprint {
  double radius, step;
  double z_min, z_max;
  double inner, smallest_part;  ///< [-] 2^-halvings
  std::uint32_t first, count;   ///< edges
  std::uint32_t halvings;       ///< of a refused step, until the gap is small enough
  std::uint32_t spare;
};

/// robots::FootprintEdge.
struct FleetEdge {
  double ax, ay;
  double bx, by;
  double z_min, z_max;
  std::uint32_t solid, spare_0, spare_1, spare_2;
};

/// A wall that stops robots.
struct FleetWall {
  double ax, ay;
  double bx, by;
  double z_min, z_max;
};

/// base::BoxTree::Node.
struct FleetNode {
  double x_min, y_min;
  double x_max, y_max;
  std::uint32_t end, first, count, spare;
};

/// Direction of a border between contact sectors.
struct FleetBorder {
  double x, y;
};

/// A mover's pose, with the sine and cosine of its yaw.
struct FleetPose {
  double x, y;
  double z, yaw;
  double sine, cosine;
};

/// The rest of robots::Fleet::Progress. Between ticks, the velocity is that of the report.
struct FleetMotion {
  double forward, left;
  double turn, remaining;  ///< [s] left of the tick; 0: finished
  std::uint32_t refused, free, exposed, spare;
};

/// State of a mover in a round that other movers read.
struct FleetShared {
  double travel;          ///< [m] largest travel of its origin in this tick
  std::uint32_t waiting;  ///< 1: its tick is not finished
  std::uint32_t changed;  ///< 1: it moved or yielded in this round
};

/// State of a mover that no other mover reads.
struct FleetOwn {
  std::uint32_t phase;    ///< twice the round, plus 1 after its path was proposed; SF_FLEET_DONE, SF_FLEET_FAILED
  std::uint32_t contact;  ///< 1: a step was refused, or it touches something
  std::uint32_t mask;     ///< touched sectors
  std::uint32_t round;    ///< SF_ROUND_OUT, ...
};

}  // namespace sf::robots

#endif
#endif
