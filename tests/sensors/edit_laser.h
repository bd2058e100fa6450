#pragma once
// Changes lasers of movers in hand-made worlds in place.

#include <algorithm>

#include "sensors/laser_settings.h"
#include "world/world.h"

namespace sf::scenes {

inline bool is_laser(const world::Sensor& sensor) { return sensors::is_laser(sensor.type); }

/// The settings of one laser. The destructor writes them back to its sensor.
class LaserEdit {
 public:
  LaserEdit(world::Sensor& sensor, const sensors::LaserSettings& laser) : sensor_(sensor), laser_(laser) {}
  LaserEdit(const LaserEdit&) = delete;
  LaserEdit& operator=(const LaserEdit&) = delete;
  ~LaserEdit() { sensor_ = sensors::laser_sensor(laser_); }
  sensors::LaserSettings* operator->() { return &laser_; }

 private:
  world::Sensor& sensor_;
  sensors::LaserSettings laser_;
};

/// Edits the i-th laser of a mover without arrays of transducers, as in `edit_laser(mover)->rate = 5.0;`
inline LaserEdit edit_laser(world::Mover& mover, std::size_t i = 0) {
  auto at = std::find_if(mover.sensors.begin(), mover.sensors.end(), is_laser);
  for (std::size_t k = 0; k < i; ++k) at = std::find_if(at + 1, mover.sensors.end(), is_laser);
  return {*at, sensors::lasers_of(mover).at(i)};
}

/// Calls `change(laser)` for each laser of the mover.
template <class Change>
void edit_lasers(world::Mover& mover, Change&& change) {
  std::vector<sensors::LaserSettings> lasers = sensors::lasers_of(mover);
  auto laser = lasers.begin();
  for (world::Sensor& sensor : mover.sensors) {
    if (!is_laser(sensor)) continue;
    change(*laser);
    sensor = sensors::laser_sensor(*laser++);
  }
}

inline void remove_lasers(world::Mover& mover) { std::erase_if(mover.sensors, is_laser); }

}  // namespace sf::scenes
