#pragma once
// The ways of a road network: evenly sampled lines, with the stretches on which two ways are too close to each other
// for two robots to pass at once.
//
//   LaneCorridors corridors(roads, world, footprint_of(mover));
//   for (const RoadPosition& place : corridors.positions(X_WM, reach)) ... place.way, place.s
//
// A way is a lane, the connection of an exit, a lane change, or a straight line within a zone. Two ways conflict where
// their lines are nearer than the width of two robots and a margin: at crossings of exits, where exits enter the same
// lane, and where lanes cross, unless one is above the other by the height of a robot. Two ways that leave the same
// point do not conflict, nor do two consecutive ways, because one robot follows the other there.

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

/// Dimensions [m] of a robot that matter on a road.
struct RoadFootprint {
  double radius = 0.165;  ///< > 0
  double front = 0.165;   ///< from the origin to the front
  double height = 0.1;    ///< from the lowest to the highest part, > 0

  friend bool operator==(const RoadFootprint&, const RoadFootprint&) = default;
};
/// Returns the dimensions of the parts of a mover that collide; virtual scanners do not.
RoadFootprint footprint_of(const world::Mover& mover);

/// Stretches of two ways that two robots cannot occupy at once, in metres along each way, measured at the robots'
/// origins.
struct Conflict {
  std::uint32_t way = 0;  ///< row of the other way
  double from = 0.0, to = 0.0;
  double other_from = 0.0, other_to = 0.0;
  bool yields = false;  ///< this way enters the other one between its ends, and robots on the other way have priority
};

/// Conflicts of one way that are too close together for a robot to wait between them.
struct ConflictZone {
  double hold = 0.0;  ///< [m] a robot's origin waits here; negative: on the preceding way
  double end = 0.0;   ///< [m] from here on the robot is clear of the other ways
  std::vector<Conflict> conflicts;
};

/// A stop line of a lane.
struct LaneStop {
  double s = 0.0;                     ///< [m] along the lane
  std::vector<std::uint32_t> lights;  ///< rows of `World::lights` that govern it; empty: a stop sign
};

struct Way {
  enum class Kind : std::uint8_t { lane, exit, change, zone };
  Kind kind = Kind::lane;
  std::uint32_t from = world::kNone;  ///< row of the lane that it leaves; kNone: none
  std::uint32_t into = world::kNone;  ///< row of the lane that it enters; kNone: none
  double leave = 0.0;                 ///< [m] along `from`
  double enter = 0.0;                 ///< [m] along `into`
  bool at_end = false;                ///< exits: it leaves at the end of its lane
  bool backwards = false;             ///< robots drive it in reverse
  bool in_zone = false;               ///< it leads into, through, or out of a zone
  std::uint32_t zone = world::kNone;  ///< row of that zone

  double length = 0.0;                       ///< [m] > 0
  double step = 0.0;                         ///< [m] between neighbouring points
  std::vector<glm::dvec2> points;            ///< at least two
  std::vector<double> z;                     ///< [m] height at each point; empty: on the floor
  std::vector<double> yaw;                   ///< [rad] yaw of the line at each point, not wrapped
  std::vector<glm::dvec2> tangents;          ///< unit vectors
  std::vector<double> curvature;             ///< [1/m] positive to the left
  std::vector<ConflictZone> conflict_zones;  ///< in order
  std::vector<LaneStop> stops;               ///< lanes: in order
  /// Lanes: points where robots wait for the conflict zones of the lane and of its exits, in order.
  std::vector<double> lines;
  std::vector<std::uint32_t> out;  ///< lanes: rows of the ways that leave it
};

glm::dvec2 point_on(const Way& way, double s);
double height_on(const Way& way, double s);
double yaw_on(const Way& way, double s);
double curvature_on(const Way& way, double s);

/// A possible position of a robot on the roads.
struct RoadPosition {
  std::uint32_t way = 0;
  double s = 0.0;       ///< [m] along the way
  double offset = 0.0;  ///< [m] >= 0 from the way's line
};

/// The positions of one robot, nearest way first.
struct RoadPositions {
  std::array<RoadPosition, 8> all;
  std::uint32_t count = 0;
  const RoadPosition* begin() const { return all.data(); }
  const RoadPosition* end() const { return all.data() + count; }
};

/// An edge of the route graph. Nodes are rows of `RoadNetwork::index`.
struct Edge {
  std::uint32_t to = 0;
  /// Driven one after the other; the second may be kNone.
  std::array<std::uint32_t, 2> ways{world::kNone, world::kNone};
  double from_s = 0.0, to_s = 0.0;  ///< [m] along the first; the second is driven completely
  double cost = 0.0;                ///< [m]
};

/// Limit for all ways of a network together, with four points per body radius: about 400 MB.
inline constexpr double kMaxWayPoints = 4e6;

/// Immutable after construction; callable from any number of threads. The network and the world must outlive it.
class LaneCorridors {
 public:
  /// @throws base::InputError for a body so small that the lines would have more than kMaxWayPoints points
  LaneCorridors(const world::RoadNetwork& roads, const world::World& world, const RoadFootprint& body);

  const world::RoadNetwork& roads() const { return roads_; }
  const RoadFootprint& body() const { return body_; }
  const std::vector<Way>& ways() const { return ways_; }
  const Way& way(std::uint32_t row) const { return ways_[row]; }
  /// Returns the edges that start at a node.
  const std::vector<Edge>& edges(std::uint32_t node) const { return edges_[node]; }
  std::uint32_t node_of(world::PointRef at) const;

  /// Returns the ways within `reach` [m] of the robot that run in its direction (within 45 degrees), nearest first. On
  /// roads with heights, only those at its own.
  RoadPositions positions(const Pose& X_WM, double reach) const;
  /// Returns whether `p` is within the perimeter of the zone or at most half a radius outside it, since spots may be
  /// entered from the perimeter.
  bool inside(std::uint32_t zone, glm::dvec2 p) const;
  /// Returns the pose of a robot's origin when parked in a spot.
  Pose parked(std::uint32_t spot) const;
  /// Returns whether robots at the heights `z` and `w` [m] pass over each other. Always false on flat roads.
  bool apart(double z, double w) const { return raised_ && std::abs(z - w) >= body_.height; }
  /// Returns the distance [m] below which two lines conflict.
  double clearance() const { return clearance_; }

 private:
  void add_lanes(const world::World& world);
  void add_exits();
  void add_changes();
  void add_zones();
  std::uint32_t add_way(Way way, const world::Curve& line, double from_z = 0.0, double to_z = 0.0);
  void raise(Way& way, const world::RoadLane& lane);
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
  double points_ = 0.0;  ///< number of points of all ways
  bool raised_ = false;  ///< a road has a height
  std::vector<Way> ways_;
  std::vector<std::vector<Edge>> edges_;

  // Samples of all ways in square grid cells, each half as wide as the clearance, or wider on large networks.
  struct Sample {
    glm::dvec2 p, along;  ///< position, and unit vector of the driving direction
    std::uint32_t way, index;
    double z;  ///< [m]
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

/// Returns the same corridors for all robots of one shape on one network as long as any robot holds them: the tables
/// are large, and a shared table stays in the processor's cache. Callable from any thread.
std::shared_ptr<const LaneCorridors> shared_lane_corridors(const world::RoadNetwork& roads, const world::World& world,
                                                           const RoadFootprint& body);

}  // namespace sf::control
