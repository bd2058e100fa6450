#pragma once
// Who goes first where ways meet: one rule that every robot computes from what all robots tell of themselves (V2V) and
// from the lights, so that no two robots that meet both think that it is their turn.
//
// A robot that has passed the place where it should have waited, or could not stop before it any more, is in the
// crossing: all others that meet any way it may take wait. Of those that approach or stand (the first of each lane),
//   1. who need not stop (no stop line, or a green light) goes before who must; a red light keeps its lane out of this;
//   2. then who came first: came within kApproachDistance, or stood at its stop line;
//   3. then the smaller id.
// Who merges behind a robot goes before the robot that followed it until then. Who has waited for kMaxWait takes part
// in a lottery instead, drawn anew every kLotteryPeriod from (id, time) and so the same for all: a robot that cannot
// use its turn, since the lane it wants is full, does not keep the others waiting.
//
// Two robots that decide at one time see the same poses and so agree on the order; what either has begun the other sees
// at its next decision. Which exit another takes is not told: all that its lane has are counted.

#include <cstdint>
#include <vector>

#include "control/controller.h"
#include "control/lane_corridors.h"

namespace sf::control {

inline constexpr double kApproachDistance = 0.5;               ///< [m] before where one waits
inline constexpr std::int64_t kMaxWait = 3'000'000'000;        ///< [ns]
inline constexpr std::int64_t kLotteryPeriod = 1'000'000'000;  ///< [ns]
inline constexpr double kHardBraking = 0.6;                    ///< [m/s^2] that every robot can do

/// What a stop line asks for.
enum class Rule : std::uint8_t { free, stop, closed };
Rule rule_of(const LaneStop& mark, std::span<const world::Signal> signals);

/// A robot before a place where it may have to wait.
struct Approach {
  std::uint32_t lane = world::kNone;  ///< way; kNone: nowhere
  double line = 0.0;                  ///< [m] along the lane, where its origin waits
  double ahead = 0.0;                 ///< [m] still to go; negative: beyond it
  Rule rule = Rule::free;
  bool first = false;      ///< nobody is between it and the line
  bool contends = false;   ///< it would go if it were alone
  std::int64_t since = 0;  ///< [ns] when it began to contend
};

/// A robot on the roads.
struct RoadUser {
  std::uint32_t id = 0;
  std::uint32_t follows = base::kNoId;
  Pose X_WM;
  glm::dvec2 velocity;  ///< [m/s] world frame
  double speed = 0.0;   ///< [m/s] >= 0
  RoadPositions positions;
  Approach approach;
};

class RightOfWay {
 public:
  RightOfWay(const LaneCorridors& corridors, std::uint32_t own_id);

  /// Takes in one moment. Robots beyond `kSensingRange` are left out, but not whom it follows and who
  /// follows it.
  /// @param follows whom it follows itself
  /// @param merges it is the one who comes in between
  void observe(const ControllerInput& input, std::uint32_t follows, bool merges);

  /// Everyone in sight; the first is the robot itself. Lives until the next `observe`.
  const std::vector<RoadUser>& road_users() const { return road_users_; }

  /// Nobody is in the way within the gate, and nobody goes first.
  bool may_enter(std::uint32_t way, const ConflictZone& conflict_zone) const;
  /// It can no longer stop `ahead` [m] before it.
  bool committed(double ahead, double speed) const;
  /// Nobody drives about in the zone, or is on its way in.
  bool zone_free(std::uint32_t zone) const;

 private:
  struct Arrival {
    std::uint32_t id, lane;
    double line;
    std::int64_t since, seen;
    bool stood, contends;
  };
  struct Known {
    std::uint32_t id;
    Pose X_WM;
    RoadPositions positions;
    std::int64_t seen;
  };
  const RoadPositions& positions_of(std::uint32_t id, const Pose& X_WM);
  void add(std::uint32_t id, const base::Report& state, std::uint32_t follows);
  void find_approach(RoadUser& driver, std::span<const world::Signal> signals) const;
  void remember(RoadUser& driver, std::int64_t time);
  bool is_in_way(const RoadUser& other, const Conflict& conflict, const Approach& own) const;
  bool precedes(const RoadUser& other, const Approach& own) const;

  const LaneCorridors& corridors_;
  std::uint32_t own_id_;
  double margin_;
  bool merges_ = false;
  std::int64_t time_ = 0;
  std::vector<RoadUser> road_users_;
  std::vector<Arrival> arrivals_;
  std::vector<Known> known_;  ///< where everyone was seen last
};

}  // namespace sf::control
