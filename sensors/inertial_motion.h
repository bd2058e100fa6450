#pragma once
// Mean angular rate and specific force of a sensor on a mover, as devices that integrate both report them.
//
// Movers keep a constant velocity in their own frame from tick to tick (robots::velocity_between), and change it at
// once at a tick. So, between ticks, the angular rate w and the acceleration of the sensor's origin, w x v, are
// constant in the sensor's frame. A mean has the changes of velocity at the ticks from the start of its time up to,
// but not at, its end, where the next velocity is not yet known.

#include <cstdint>
#include <vector>

#include "base/bytes.h"
#include "base/report.h"
#include "base/rigid_transform.h"

namespace sf::sensors {

/// Means over a time, in the sensor's frame, which turns meanwhile.
struct InertialMeans {
  glm::dvec3 rate;   ///< [rad/s]
  glm::dvec3 force;  ///< [m/s^2] acceleration less that of free fall: upwards at rest
};

class InertialMotion {
 public:
  /// @param X_MS sensor in the mover's frame  @param duration [ns] > 0 of the means  @param max_speed [m/s] of the
  /// mover
  /// @param gravity [m/s^2] acceleration of free fall, along -z of the world
  InertialMotion(const base::RigidTransform& X_MS, std::int64_t duration, double max_speed, double gravity)
      : X_MS_(X_MS), duration_(duration), max_speed_(max_speed), gravity_(gravity) {}

  /// Adds the state of a tick. Times increase. A mover that was relocated, or returns, was at rest there.
  void add(const base::Report& state);
  void clear();
  /// Returns the means up to `now`: the state of the last tick, or a later one. Before the first tick the mover was at
  /// rest.
  InertialMeans mean(const base::Report& now) const;
  /// Returns the means at rest in a place.
  InertialMeans at_rest(const base::Report& state) const { return {{}, gravity_ * up(state)}; }

  void write(base::ByteWriter& out) const;
  void read(base::ByteReader& in);

 private:
  /// Motion between two ticks, in the sensor's frame.
  struct Segment {
    std::int64_t from = 0, to = 0;  ///< [ns]
    glm::dvec3 v;                   ///< [m/s] of the sensor's origin
    glm::dvec3 w;                   ///< [rad/s]
    glm::dvec3 up;                  ///< direction of the world's z, at `from`
  };
  glm::dvec3 up(const base::Report& state) const;
  Segment segment(const base::Report& from, const base::Report& to) const;

  base::RigidTransform X_MS_;
  std::int64_t duration_;
  double max_speed_;
  double gravity_;
  base::Report last_;              ///< of the last tick
  bool known_ = false;             ///< `last_` is set
  std::vector<Segment> segments_;  ///< by time, without gaps, up to `last_`
  std::size_t first_ = 0;          ///< in `segments_`: the first that a later mean may need
};

}  // namespace sf::sensors
