#pragma once
// Tracks: objects around robots, fused from features of several sensors, as a derived sensor (docs/derived.md).
//
// In a world file, inside a robot:
//   derived( type "features" name "scan" inputs ["laser"] )
//   derived( type "tracks"  inputs ["features:0" "features:1" "localization"]  rate 10  most 15  keep 1  agility 0.2
//   speed 1 )
// Inputs: any number of `features` and radars, at least one, and one pose of each of their robots: sensors whose
// columns begin with x_m, y_m, yaw_rad. `most`: rows of a reading. `keep`: [s] a track ends after this time without an
// observation. `agility`: [m/s^1.5] in time t an object's speed changes by agility sqrt(t). `speed`: [m/s] standard
// deviation of the velocity of a new track. `radius`: [m] half the width of the corridor in which an object is ahead,
// and the distance of a contact; default: that of the robot's outline. `extent`: [m] from the surface of an object to
// its middle where its width is not seen, as with echoes of cones and targets of radars; default: as the robot's own
// outline, at most 0.5 m.
//
// A reading is `most` rows in the order of identities, moving objects and then the nearest first if there are too many:
// position and velocity in the world frame, `valid`, covariance, then identity, kind (1 object at rest, 2 moving
// object, 3 corner), tag, and the decisions: the distance of an object ahead of the robot, and the time to contact, NaN
// without one.

#include "sensors/derived/derived_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kTracks = 39;        ///< wire id
inline constexpr std::uint32_t kMostObjects = 15;  ///< rows: one datagram

/// Columns of a row.
inline constexpr std::size_t kTrackNumbers = 20, kTrackValidAt = 4, kTrackCovarianceAt = 5, kTrackIdentityAt = 15,
                             kTrackKindAt = 16, kTrackTagAt = 17, kTrackAheadAt = 18, kTrackContactAt = 19;

extern const SensorType tracks_type;

}  // namespace sf::sensors
