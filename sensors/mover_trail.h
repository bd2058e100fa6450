#pragma once
// Recent states of a mover, for its poses during a rolling scan.

#include <cstdint>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/report.h"

namespace sf::sensors {

/// Equal poses and tilts, to the bit.
inline bool is_same_place(const base::Report& a, const base::Report& b) {
  return a.X_WM.x == b.X_WM.x && a.X_WM.y == b.X_WM.y && a.X_WM.z == b.X_WM.z && a.X_WM.yaw == b.X_WM.yaw &&
         a.tilt.roll == b.tilt.roll && a.tilt.pitch == b.tilt.pitch;
}

class MoverTrail {
 public:
  /// @param duration [ns] that `at` looks back  @param max_speed [m/s] of the mover
  MoverTrail(std::int64_t duration, double max_speed) : duration_(duration), max_speed_(max_speed) {}

  /// Adds the state of a tick. Times increase. An absent mover's trail ends.
  void add(const base::Report& state);
  void clear() { states_.clear(); }
  /// Returns the state at `time` [ns] on the arcs between the ticks, and from the last tick to `now`. Before the first
  /// tick and before a relocation, which takes place at the beginning of its tick, the mover stood still.
  base::Report at(std::int64_t time, const base::Report& now) const;
  /// Returns the greatest distance [m] of the positions since the oldest tick from that of `now`.
  double reach(const base::Report& now) const;

  /// True if the mover stood still since `time` [ns], at most `duration` before `now`.
  bool at_rest(std::int64_t time, const base::Report& now) const;
  /// Continues another trail of the mover.
  void take_over(MoverTrail& before) { states_ = std::move(before.states_); }
  /// True if it begins before another trail of the same mover.
  bool is_longer(const MoverTrail& other) const;

  void write(base::ByteWriter& out) const;
  void read(base::ByteReader& in);

 private:
  bool drove(const base::Report& from, const base::Report& to) const;
  base::Report between(const base::Report& from, const base::Report& to, std::int64_t time) const;

  std::int64_t duration_;
  double max_speed_;
  std::vector<base::Report> states_;  ///< by time
};

}  // namespace sf::sensors
