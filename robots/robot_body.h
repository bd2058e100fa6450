#pragma once
// One simulated robot in a process of its own: it moves among the world's walls and the robots that it was told of.

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/report.h"
#include "robots/fleet.h"
#include "world/world.h"

namespace sf::robots {

/// Times are of the robot's own clock [ns], which does not go back.
class RobotBody {
 public:
  /// @param mover its row; all begin where they are at load
  /// @param forget [ns] a robot that spoke, and was silent for so long, is in nobody's way any more; 0: it stays
  RobotBody(const world::World& world, std::uint32_t mover, std::int64_t forget = 0);

  /// Another robot says where it is; it came now.
  void update_other(std::uint32_t mover, const base::Pose& X_WM, const base::Twist& velocity, std::int64_t now);

  /// Drives from where it was until `now`, half a second at most (a stopped process stood). Others go on as they said,
  /// for half a second; then they stand.
  void move(const base::Twist& command, std::int64_t now);

  const base::Report& state() const { return fleet_.reports()[mover_]; }
  const base::Report& state(std::uint32_t mover) const { return fleet_.reports()[mover]; }
  bool contact() const { return fleet_.contacts()[mover_] != 0; }
  double distance() const { return distance_; }  ///< [m] driven
  /// Where it was at `time`, between the moves it remembers (the last 256); before these, at the first of them.
  base::Pose pose_at(std::int64_t time) const;

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
  struct OtherRobot {
    base::Twist velocity;
    std::int64_t until = 0;      ///< [ns]
    std::int64_t gone = kNever;  ///< [ns] when it is forgotten
  };
  struct TrailPoint {
    std::int64_t time = 0;  ///< [ns]
    base::Pose X_WM;
  };
  const TrailPoint& trail_point(std::size_t back) const { return trail_[(moves_ - back) % trail_.size()]; }

  world::World world_;  ///< a copy: others move as they say they do, whatever stands between their commands and them
  Fleet fleet_;
  std::uint32_t mover_;
  std::int64_t forget_;                ///< [ns]; 0: nobody is forgotten
  std::vector<OtherRobot> others_;     ///< per mover
  std::vector<base::Twist> commands_;  ///< per mover
  std::array<TrailPoint, 256> trail_;
  std::size_t moves_ = 0;  ///< the last one is at `moves_` % size
  std::int64_t time_ = 0;
  double distance_ = 0.0;
};

}  // namespace sf::robots
