#pragma once
// Inductive loops in the road: count vehicles, and measure occupancy and spot speed (docs/sensors.md).
//
// In a world file, inside a robot or a linked model, usually one that stands at the roadside:
//   loop( pose [3 0 0 0]  size [2 2]  rate 1 )
// The loop is a rectangle of `size` [along across] about its pose. It detects each mover but its carrier whose outline
// overlaps the rectangle, at the carrier's height (kLevelHeight).
//
// A reading is one row: passages since the start, counted when a vehicle enters; the share of the time since the last
// reading in which the loop was covered; the mean speed, on entering, of the vehicles that entered since then (NaN:
// none); the vehicles on it now. Vehicles that are on it at the start are not counted; one that appears on it, or was
// relocated onto it, is, without a speed.
//
// Between ticks vehicles follow robots::interpolate. They are tested each time that a point has moved by a quarter of
// the rectangle's shorter side; a contact that is shorter may be missed. Times of entry and exit are exact to 1 ns.

#include <cstdint>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kLoop = 36;    ///< wire id
inline constexpr double kLevelHeight = 0.5;  ///< [m] largest difference between origins of vehicle and carrier

/// Settings of one loop.
struct LoopSize {
  double length = 2.0;  ///< [m] > 0, along the loop's x axis
  double width = 2.0;   ///< [m] > 0
};

/// Returns whether the rectangle `size` about `X_WL` and the outline of a mover at `X_WM` share a point.
bool covers(const LoopSize& size, const Pose& X_WL, const world::Mover& mover, const Pose& X_WM);

extern const SensorType loop_type;

}  // namespace sf::sensors
