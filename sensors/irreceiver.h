#pragma once
// The iRobot Create's omnidirectional infrared receiver for virtual walls and docks (docs/sensors.md describes their
// geometry).
//
// In a world file, inside a robot:
//   irreceiver()
// A reading is one row. The first column is 1 in a virtual wall's beam or halo, else 0. The second column is the byte
// of visible docks in the Create's Open Interface: 240 plus 8 for the red buoy, 4 for the green buoy and 2 for the
// force field, or 255 for none. Walls that lasers detect at the receiver's height block light. The emitter's own body
// and movers do not.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kIrReceiver = 11;  ///< wire id
inline constexpr std::uint32_t kNoIrByte = 255;
inline constexpr std::uint32_t kDockByte = 240;  ///< plus the bits of the visible signals
inline constexpr std::uint32_t kRedBuoy = 8;
inline constexpr std::uint32_t kGreenBuoy = 4;
inline constexpr std::uint32_t kForceField = 2;

/// Returns the signals of one emitter at a point of the plane, ignoring walls.
/// @return virtual wall: 1 in its beam or halo; dock: bits kRedBuoy, kGreenBuoy, kForceField; 0: none
std::uint32_t light_of(const world::Emitter& emitter, glm::dvec2 p);

extern const SensorType irreceiver_type;

}  // namespace sf::sensors
