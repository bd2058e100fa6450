#pragma once
// Right of way at conflict zones. Every robot computes the same rule from the V2V states of all robots and from the
// traffic lights, so that two conflicting robots never both take the right of way.
//
// A robot that has passed its waiting line, or can no longer stop before it, occupies the crossing: all robots whose
// ways conflict with any way it may take must wait. Among the other robots near a line (the first of each lane),
//   1. a robot that need not stop (no stop line, or a green light) precedes one that must; robots at a red light do not
//      take part;
//   2. then the earlier arrival precedes: the time of coming within kApproachDistance or of stopping at the stop line;
//   3. then the smaller id.
// A robot that merges behind a leader precedes the robot that has followed this leader until then. Once either of two
// robots has waited longer than kMaxWait, a lottery decides between them. It is drawn every kLotteryPeriod from (id,
// time), with the same result on all robots. Without it, a robot that cannot use its turn because its lane is full
// would block the others.
//
// Robots that decide at the same time see the same poses and agree on the order; at its next decision a robot observes
// the motion that the other has begun. V2V packets do not state the chosen exit, so all exits of a robot's lane count.

#include <cstdint>
#include <vector>

#include "base/time.h"
#include "control/controller.h"
#include "control/lane_corridors.h"

namespace sf::control {

inline constexpr double kApproachDistance = 0.5;               ///< [m] distance before the waiting line
inline constexpr std::int64_t kMaxWait = 3'000'000'000;        ///< [ns]
inline constexpr std::int64_t kLotteryPeriod = base::kSecond;  ///< [ns]
inline constexpr double kHardBraking = 0.6;                    ///< [m/s^2] deceleration that every robot can achieve

/// Rule at a stop line.
enum class Rule : std::uint8_t { free, stop, closed };
Rule rule_of(const LaneStop& mark, std::span<const world::Signal> signals);

/// A robot's approach to a waiting line.
struct Approach {
  std::uint32_t lane = world::kNone;  ///< row of the way; kNone: no approach
  double line = 0.0;                  ///< [m] along the lane, where the robot's origin waits
  double ahead = 0.0;                 ///< [m] remaining distance; negative: beyond the line
  Rule rule = Rule::free;
  bool first = false;      ///< no robot is between it and the line
  bool contends = false;   ///< it takes part in the order of precedence
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

  /// Updates the road users from the states at one time. Excludes robots farther than 3.5 m away, except its leader and
  /// its followers.
  /// @param follows id of its own leader; kNoId: none
  /// @param merges it has yet to merge behind the leader
  void observe(const ControllerInput& input, std::uint32_t follows, bool merges);

  /// Continues on a network with other lane uses. Keeps the order of arrivals.
  void use(const LaneCorridors& corridors);

  /// Returns all observed robots; the first is the robot itself. Valid until the next `observe`.
  const std::vector<RoadUser>& road_users() const { return road_users_; }

  /// Returns whether no robot occupies the conflict zone or precedes this one.
  bool may_enter(std::uint32_t way, const ConflictZone& conflict_zone) const;
  /// Returns whether a robot can no longer stop within `ahead` [m].
  bool committed(double ahead, double speed) const;
  /// Returns whether no robot drives in the zone or is entering it.
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

  const LaneCorridors* corridors_;
  std::uint32_t own_id_;
  double margin_;
  bool merges_ = false;
  std::int64_t time_ = 0;
  std::vector<RoadUser> road_users_;
  std::vector<Arrival> arrivals_;
  std::vector<Known> known_;  ///< last poses and positions of all observed robots
};

}  // namespace sf::control
