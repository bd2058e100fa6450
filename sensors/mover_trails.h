#pragma once
// Recent states of all movers, for rolling scans: each beam leaves the sensor, and meets the other movers, where they
// were at the beam's time.

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/report.h"
#include "base/rigid_transform.h"
#include "sensors/mover_trail.h"
#include "world/copies.h"
#include "world/world.h"

namespace sf::sensors {

inline constexpr double kMostTrailStates = 5e6;  ///< of all movers, 96 bytes each

/// Not thread-safe, but any number of threads may ask for poses.
class MoverTrails {
 public:
  /// @param world of the movers; outlives this, as `states`, per mover and current whenever a function is called
  /// @param duration [ns] of the longest rolling scan; 0: no scan rolls, and nothing is kept
  /// @throws base::InputError if more than kMostTrailStates would be kept
  MoverTrails(const world::World& world, std::span<const base::Report> states, std::int64_t duration);

  bool empty() const { return trails_.empty(); }
  std::int64_t now() const { return now_; }  ///< [ns] of the last tick or sample
  /// Adds the states of a tick, or sets those of a sample between two ticks. @param now [ns]
  void add(std::int64_t now, bool between);
  /// The movers of this mover's world begin an episode at `now` [ns].
  void restart(std::uint32_t mover, std::int64_t now);
  /// Continues the trails of a process's earlier movers. @param before must not be used afterwards
  void take_over(MoverTrails& before);

  /// True if the mover is where the last tick or sample left it, not at a pose of a single reading.
  bool is_here(std::uint32_t mover) const { return is_same_place(states_[mover], last_[mover]); }
  /// True if it stood still since `time` [ns], within the longest scan.
  bool at_rest(std::uint32_t mover, std::int64_t time) const { return trails_[mover].at_rest(time, now(mover)); }
  /// True if the mover, or another one of its world within `range` [m] of it, did not.
  bool any_moves(std::uint32_t mover, std::int64_t time, double range) const;
  base::RigidTransform X_WM(std::uint32_t mover, std::int64_t time) const;
  /// As MoverTrail::reach.
  double reach(std::uint32_t mover) const { return trails_[mover].reach(now(mover)); }

  /// Writes the trails of a mover and of all others of its world that this process knows and that moved; or reads
  /// them, where they begin before its own. Another process that sees the mover from now on may not have seen these.
  void write(std::uint32_t mover, base::ByteWriter& out) const;
  void read(base::ByteReader& in);

 private:
  base::Report now(std::uint32_t mover) const;

  const world::World& world_;
  std::span<const base::Report> states_;
  world::CopyIndex copies_;
  std::int64_t duration_;
  std::vector<MoverTrail> trails_;  ///< per mover; empty: no scan rolls
  std::vector<base::Report> last_;  ///< per mover, in the last tick or sample
  std::int64_t now_ = 0;
};

}  // namespace sf::sensors
