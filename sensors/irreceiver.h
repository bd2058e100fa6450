#pragma once
// The iRobot Create's infrared receiver: sees virtual walls and docks all round (docs/sensors.md has their geometry).
//
// In a world file, inside a robot:
//   irreceiver()
// A reading is one row: 1 while the receiver is in a virtual wall's beam or halo, else 0; and the byte of docks in
// sight as the Create's Open Interface has it: 240 and 8 for the red buoy, 4 for the green buoy, 2 for the force field,
// or 255 for none. Light is stopped by walls that lasers see at the receiver's height, but not by the emitter's own
// body, and not by movers.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kIrReceiver = 11;  ///< wire id
inline constexpr std::uint32_t kNoIrByte = 255;
inline constexpr std::uint32_t kDockByte = 240;  ///< and the bits of what is in sight
inline constexpr std::uint32_t kRedBuoy = 8;
inline constexpr std::uint32_t kGreenBuoy = 4;
inline constexpr std::uint32_t kForceField = 2;

/// What of one emitter's light is at a point of the plane, walls aside.
/// @return a virtual wall: 1 in its beam or halo; a dock: bits kRedBuoy, kGreenBuoy, kForceField; 0: none
std::uint32_t light_of(const world::Emitter& emitter, glm::dvec2 p);

extern const SensorType irreceiver_type;

}  // namespace sf::sensors
