#pragma once
// A road network in world metres: lanes as smooth lines with edges and markings, and the transitions between lanes.
// Consists of tables in file order, joined by row number. Immutable once built.
//
//   RoadNetwork roads = load_roads("site.rndf", warnings);         // world/roads/roads.h
//   const glm::dvec2 p = position_of(roads, *find_point(roads, {1, 2, 3}));

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "world/roads/curve.h"
#include "world/roads/rndf.h"
#include "world/roads/sidecar.h"
#include "world/world.h"

namespace sf::world {

/// Refers to a point by its row in the tables.
struct PointRef {
  enum class Kind : std::uint8_t { lane, perimeter, spot };
  Kind kind = Kind::lane;
  std::uint32_t row = 0;    ///< in `lanes`, `zones` or `spots`
  std::uint32_t index = 0;  ///< among the points of that row; for a spot, 0 is the entry and 1 the end

  friend bool operator==(const PointRef&, const PointRef&) = default;
};

struct LanePoint {
  PointId id;
  glm::dvec2 p;      ///< [m] world frame
  double s = 0.0;    ///< [m] along the lane's centre line, from 0 to the lane's length, non-decreasing
  double yaw = 0.0;  ///< [rad] driving direction; 0 for a lane of one point
  double z = 0.0;    ///< [m] height of the road; linear along the centre line between way-points
};

/// Invariant: a lane with one way-point (or only coincident ones) has a centre line of one point and no edges.
struct RoadLane {
  std::uint32_t segment = 0;  ///< row in `segments`
  int number = 0;             ///< in the file
  double width = 0.0;         ///< [m] > 0
  Boundary left = Boundary::none;
  Boundary right = Boundary::none;
  std::vector<LanePoint> points;       ///< at least one, in driving direction
  Curve centre;                        ///< its knots are `points`
  std::vector<glm::dvec2> left_edge;   ///< [m] half the width to the left of the centre line, in driving direction
  std::vector<glm::dvec2> right_edge;  ///< [m] half the width to the right
  bool open = true;                    ///< false: no route enters it (world/roads/lane_use.h)
};
inline double length_of(const RoadLane& lane) { return lane.centre.s.back(); }

struct RoadSegment {
  int id = 0;
  std::string name;
  std::uint32_t first_lane = 0;  ///< rows [first_lane, first_lane + lanes) of `lanes`
  std::uint32_t lanes = 0;
};

struct PerimeterPoint {
  PointId id;
  glm::dvec2 p;  ///< [m] world frame
};

struct RoadZone {
  int id = 0;
  std::string name;
  std::vector<PerimeterPoint> perimeter;  ///< closed: the last point is connected to the first
  std::uint32_t first_spot = 0;           ///< rows [first_spot, first_spot + spots) of `spots`
  std::uint32_t spots = 0;
};

struct RoadSpot {
  std::uint32_t zone = 0;  ///< row in `zones`
  int number = 0;
  double width = 0.0;  ///< [m] > 0
  glm::dvec2 entry;    ///< [m] world frame
  glm::dvec2 end;      ///< [m] position of the front of a parked car
};

struct RoadExit {
  PointRef from;
  PointRef to;
  double length = 0.0;  ///< [m] along `exit_curve`
  bool open = true;     ///< false: no route takes it
};

/// A line across the full width of the lane. Lanes without a direction have no stop lines.
struct StopLine {
  PointRef at;
  glm::dvec2 left;   ///< [m] end on the lane's left edge
  glm::dvec2 right;  ///< [m]
  PointId lights;    ///< way-point whose lights govern it: that of `at`, except on reversed lanes
};

struct RoadCheckpoint {
  int id = 0;
  PointRef at;
  glm::dvec2 p;  ///< [m] world frame
};

/// Sizes of markings, including the scale. [m] > 0
struct MarkingSizes {
  double line_width = 0.0;
  double dash_length = 0.0;
  double dash_gap = 0.0;
  double stop_width = 0.0;
};

struct RoadNetwork {
  std::string name;
  std::string file;
  double scale = 1.0;       ///< [-] metres of the world per metre of the RNDF
  double tolerance = 1e-3;  ///< [m] largest distance between polylines and their curves
  std::vector<RoadSegment> segments;
  std::vector<RoadLane> lanes;
  std::vector<RoadZone> zones;
  std::vector<RoadSpot> spots;
  std::vector<RoadExit> exits;  ///< sorted by `from` in the order of the tables, then as in the file
  std::vector<StopLine> stops;
  std::vector<RoadCheckpoint> checkpoints;  ///< sorted by id
  MarkingSizes paint;
  RoadCounts counts;
  Extent extent;                                    ///< [m] bounds of all points, edges and spots
  std::vector<std::pair<PointId, PointRef>> index;  ///< sorted, for `find_point`
};

/// Builds the network.
/// @throws base::InputError if the sidecar refers to a missing lane or point, or if the network is too large
RoadNetwork build_network(const Rndf& rndf, const RoadSidecar& sidecar, std::vector<Warning>& warnings);

/// Returns nullopt if the network has no such point.
std::optional<PointRef> find_point(const RoadNetwork& network, PointId id);
/// Returns null if the network has no such checkpoint. Valid for the lifetime of the network.
const RoadCheckpoint* find_checkpoint(const RoadNetwork& network, int id);

PointId id_of(const RoadNetwork& network, PointRef at);
glm::dvec2 position_of(const RoadNetwork& network, PointRef at);
/// Returns the driving direction [rad]; nullopt for perimeter points and for lanes without a direction.
std::optional<double> yaw_of(const RoadNetwork& network, PointRef at);
/// Returns the name as written in the file, such as "1.2".
std::string lane_name(const RoadNetwork& network, const RoadLane& lane);

/// Returns the height [m] of the road at a point; 0 for points of zones and spots.
double height_of(const RoadNetwork& network, PointRef at);
/// Returns the height [m] of a lane's road at `s` [m] along its centre line.
double height_at(const RoadLane& lane, double s);
/// Returns the lanes and exits above the floor. An exit rises linearly between its ends.
std::vector<Ramp> ramps_of(const RoadNetwork& network);

/// A transition from one point to another.
struct Transition {
  enum class Kind : std::uint8_t { lane, exit, zone, change };
  Kind kind = Kind::lane;  ///< along the lane, by an exit, freely across a zone, or to the adjacent lane
  PointRef to;
  double length = 0.0;  ///< [m] along the lane, along the curve of an exit or change, or straight across a zone
};

/// Returns the lane changes from `at` to adjacent lanes of the same segment and direction, across a broken line or an
/// unspecified marking. Each change ends at the first point of the other lane that is at least three lane widths
/// farther along. Empty for points of zones and spots.
std::vector<Transition> lane_changes(const RoadNetwork& network, PointRef at);

/// Returns the curve of a lane change, from one lane's direction to the other's.
Curve lane_change_curve(const RoadNetwork& network, PointRef from, PointRef to);

/// Returns the curve of an exit, from the lane's direction to that of the entry; straight if a direction is unknown.
Curve exit_curve(const RoadNetwork& network, const RoadExit& exit);

}  // namespace sf::world
