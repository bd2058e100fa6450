#pragma once
// The ways of a road network as robots drive them: evenly sampled lines, and where they come so near to each other that
// two robots cannot pass at once.
//
//   LaneCorridors corridors(roads, world, footprint_of(mover));
//   for (const Place& place : corridors.places(X_WM)) ... place.way, place.s
//
// A way is a lane, the connection of an exit, a change of lanes, or a straight within a zone. Ways meet where their
// lines are nearer than two robots and a margin: at crossings of exits, where exits enter the same lane, and where
// lanes cross (a bridge is flat here: robots have no height to cross at). Leaving the same point is no meeting, nor is
// going on from one way to the next: there one robot follows the other.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/pose.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::control {

using base::Pose;

/// What of a robot's shape matters on a road. [m]
struct RoadFootprint {
  double radius = 0.165;  ///< > 0
  double front = 0.165;   ///< from its origin

  friend bool operator==(const RoadFootprint&, const RoadFootprint&) = default;
};
/// What of it stops at things: a virtual scanner does not.
RoadFootprint footprint_of(const world::Mover& mover);

/// Stretches of two ways that two robots cannot be on at once. [m] along either way, of the robots' origins.
struct Conflict {
  std::uint32_t way = 0;  ///< the other
  double from = 0.0, to = 0.0;
  double other_from = 0.0, other_to = 0.0;
  bool yields = false;  ///< this way enters the other one in its course: who is on that goes first
};

/// Meetings of one way that lie too close together to wait between them.
struct ConflictZone {
  double hold = 0.0;  ///< [m] a robot's origin waits here; negative: on the way before
  double end = 0.0;   ///< [m] from here on it is out of the way of the others
  std::vector<Conflict> conflicts;
};

/// A stop line of a lane.
struct LaneStop {
  double s = 0.0;                     ///< [m] along the lane
  std::vector<std::uint32_t> lights;  ///< rows of `World::lights` that govern it; none: a stop sign
};

struct Way {
  enum class Kind : std::uint8_t { lane, exit, change, zone };
  Kind kind = Kind::lane;
  std::uint32_t from = world::kNone;  ///< the lane's way that it leaves; kNone: none
  std::uint32_t into = world::kNone;  ///< the lane's way that it enters
  double leave = 0.0;                 ///< [m] along `from`
  double enter = 0.0;                 ///< [m] along `into`
  bool at_end = false;                ///< exits: it leaves where its lane ends
  bool backwards = false;             ///< robots drive it backwards
  bool in_zone = false;               ///< it leads into, about, or out of a zone
  std::uint32_t zone = world::kNone;  ///< row of that zone

  double length = 0.0;                       ///< [m] > 0
  double step = 0.0;                         ///< [m] from one point to the next
  std::vector<glm::dvec2> points;            ///< at least two
  std::vector<double> yaw;                   ///< [rad] of the line at each point, not wrapped
  std::vector<glm::dvec2> tangents;          ///< unit vectors
  std::vector<double> curvature;             ///< [1/m] positive to the left
  std::vector<ConflictZone> conflict_zones;  ///< in order
  std::vector<LaneStop> stops;               ///< lanes: in order
  std::vector<double>
      lines;  ///< lanes: where robots on it wait for conflict_zones of the lane and of its exits, in order
  std::vector<std::uint32_t> out;  ///< lanes: ways that leave it
};

glm::dvec2 point_on(const Way& way, double s);
double yaw_on(const Way& way, double s);
double curvature_on(const Way& way, double s);

/// Where a robot may be.
struct RoadPosition {
  std::uint32_t way = 0;
  double s = 0.0;       ///< [m] along the way
  double offset = 0.0;  ///< [m] >= 0 from its line
};

/// The likeliest ways of one robot, the nearest first; few.
struct RoadPositions {
  std::array<RoadPosition, 8> all;
  std::uint32_t count = 0;
  const RoadPosition* begin() const { return all.data(); }
  const RoadPosition* end() const { return all.data() + count; }
};

/// A way on in the graph: nodes are rows of `RoadNetwork::index`.
struct Edge {
  std::uint32_t to = 0;
  std::array<std::uint32_t, 2> ways{world::kNone, world::kNone};  ///< driven one after the other, second may be none
  double from_s = 0.0, to_s = 0.0;                                ///< [m] along the first; the second is driven whole
  double cost = 0.0;                                              ///< [m]
};

/// Immutable after construction; any number of threads. The network and the world must outlive it.
class LaneCorridors {
 public:
  LaneCorridors(const world::RoadNetwork& roads, const world::World& world, const RoadFootprint& body);

  const world::RoadNetwork& roads() const { return roads_; }
  const RoadFootprint& body() const { return body_; }
  const std::vector<Way>& ways() const { return ways_; }
  const Way& way(std::uint32_t row) const { return ways_[row]; }
  /// The way of a lane is the lane's own row.
  const std::vector<Edge>& edges(std::uint32_t node) const { return edges_[node]; }
  std::uint32_t node_of(world::PointRef at) const;

  /// Ways within `reach` [m] of the robot that run in its direction (to 45 degrees), nearest first.
  RoadPositions positions(const Pose& X_WM, double reach) const;
  /// Within the perimeter of the zone, or half a radius beyond: spots may be entered from its very rim.
  bool inside(std::uint32_t zone, glm::dvec2 p) const;
  /// The origin of a robot that is parked in a spot.
  Pose parked(std::uint32_t spot) const;
  /// How near lines come before they meet. [m]
  double clearance() const { return clearance_; }

 private:
  void add_lanes(const world::World& world);
  void add_exits();
  void add_changes();
  void add_zones();
  std::uint32_t add_way(Way way, const world::Curve& line);
  void add_edge(world::PointRef from, world::PointRef to, std::uint32_t way, double from_s, double to_s, double extra);
  void fill_grid();
  void find_conflicts();
  void find_conflicts(std::uint32_t way);
  bool joined(std::uint32_t a, std::uint32_t b) const;
  void make_conflict_zones(Way& way, std::vector<Conflict> conflicts) const;
  void make_lines();
  template <class F>
  void near(glm::dvec2 p, double reach, F&& visit) const;

  const world::RoadNetwork& roads_;
  RoadFootprint body_;
  double clearance_;
  double step_;
  std::vector<Way> ways_;
  std::vector<std::vector<Edge>> edges_;

  // Samples of all ways by square cells of the plane, each half as wide as the clearance.
  struct Sample {
    glm::dvec2 p, along;  ///< where, and which way a robot looks that drives there
    std::uint32_t way, index;
  };
  glm::dvec2 corner_;
  double cell_ = 1.0;
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> first_;
  std::vector<Sample> samples_;
};

template <class F>
void LaneCorridors::near(glm::dvec2 p, double reach, F&& visit) const {
  const auto cell = [&](double v, double low, std::int64_t most) {
    const double at = std::floor((v - low) / cell_);
    return at < 0.0 ? std::int64_t{-1} : at >= static_cast<double>(most) ? most : static_cast<std::int64_t>(at);
  };
  const std::int64_t r0 = std::max<std::int64_t>(cell(p.y - reach, corner_.y, rows_), 0);
  const std::int64_t r1 = std::min(cell(p.y + reach, corner_.y, rows_), rows_ - 1);
  const std::int64_t c0 = std::max<std::int64_t>(cell(p.x - reach, corner_.x, columns_), 0);
  const std::int64_t c1 = std::min(cell(p.x + reach, corner_.x, columns_), columns_ - 1);
  for (std::int64_t r = r0; r <= r1; ++r)
    for (std::int64_t c = c0; c <= c1; ++c) {
      const auto at = static_cast<std::size_t>(r * columns_ + c);
      for (std::uint32_t i = first_[at]; i < first_[at + 1]; ++i) visit(samples_[i]);
    }
}

/// The same corridors for all robots of one shape on one network, as long as any of them has them: they are large, and
/// one table in the processor's cache serves a crowd. Any thread.
std::shared_ptr<const LaneCorridors> shared_lane_corridors(const world::RoadNetwork& roads, const world::World& world,
                                                           const RoadFootprint& body);

}  // namespace sf::control
