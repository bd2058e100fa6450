#pragma once
// A pan-tilt-zoom camera mount that visits a list of views in turn (docs/sensors.md).
//
// In a world file, inside a robot:
//   ptz( pan [-100 100]  tilt [-30 90]  fov [3 47.5]  pan_speed 90  tilt_speed 70  zoom_speed 20
//        views 2  view[0] [0 0 47.5 2]  view[1] [45 -10 20 1] )
// A view is [pan tilt fov seconds]; the mount moves to it, holds it, and moves on. The list repeats. A reading is one
// row: pan (counter-clockwise), tilt (upwards) and the horizontal field of view. It depends on the time alone.

#include <array>
#include <cstdint>
#include <vector>

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kPtz = 31;            ///< wire id
inline constexpr std::uint32_t kMostPtzViews = 32;  ///< per mount

/// Pan, tilt and field of view [rad].
using PtzAxes = std::array<double, 3>;

/// One view: `hold` [s] >= 0 at `axes`.
struct PtzView {
  PtzAxes axes;
  double hold = 0.0;
};

/// Settings of one mount.
struct Ptz {
  PtzAxes speed;               ///< [rad/s] > 0
  std::vector<PtzView> views;  ///< at least one
};

/// Returns the position at `time` [s] >= 0. Time 0 is the start of the first view's hold. All axes move from view to
/// view in the time of the slowest one, and evenly.
PtzAxes position_of(const Ptz& mount, double time);

/// @throws base::InputError with file and line.
Ptz read_ptz(const world::Sensor& sensor);

extern const SensorType ptz_type;

}  // namespace sf::sensors
