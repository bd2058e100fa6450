// MAP messages: stop lines, lanes and connections of an intersection.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "base/pose.h"
#include "server/signal_messages.h"

namespace sf::server {

namespace {

using world::PointRef;
using world::RoadNetwork;

constexpr std::size_t kMaxLanes = 255, kMaxNodes = 63, kMaxConnections = 16;
constexpr std::uint8_t kIngress = 0b10, kEgress = 0b01;
constexpr std::array<std::int32_t, 6> kReach{511, 1023, 2047, 4095, 8191, 32'767};  ///< [cm] of node-XY1 to node-XY6

constexpr double kNodeReach = 327.0;  ///< [m] per axis, of node-XY6

std::int32_t centimetres(double metres) { return static_cast<std::int32_t>(std::lround(100.0 * metres)); }

/// Inverts LocalPlane::east_north by Newton's method; the error is below 1e-9 degrees after five steps.
world::Geodetic geodetic_of(glm::dvec2 p, world::Geodetic origin) {
  constexpr double kMetresPerDegree = 111'320.0;
  const world::LocalPlane plane(origin);
  const double east = kMetresPerDegree * std::max(1e-6, base::cos(origin.latitude * M_PI / 180.0));
  world::Geodetic at = origin;
  for (int i = 0; i < 5; ++i) {
    const glm::dvec2 rest = p - plane.east_north(at);
    at.latitude += rest.y / kMetresPerDegree;
    at.longitude += rest.x / east;
  }
  return at;
}

/// Wraps to (-180, 180] degrees, in units of 1e-7 degrees.
std::int32_t wrapped_longitude(double degrees) {
  constexpr std::int64_t kTurn = 3'600'000'000;
  const std::int64_t units = std::llround(1e7 * degrees) % kTurn;
  if (units > kTurn / 2) return static_cast<std::int32_t>(units - kTurn);
  return static_cast<std::int32_t>(units <= -kTurn / 2 ? units + kTurn : units);
}

/// Returns the points, with points inserted where two are farther apart than a node's offset reaches.
std::vector<glm::dvec2> within_reach(std::span<const glm::dvec2> points) {
  std::vector<glm::dvec2> all;
  for (const glm::dvec2& p : points) {
    const glm::dvec2 from = all.empty() ? p : all.back();
    const double steps = std::ceil(glm::length(p - from) / kNodeReach);
    for (double i = 1.0; i < steps && all.size() < kMaxNodes; ++i) all.push_back(from + i / steps * (p - from));
    all.push_back(p);
  }
  all.resize(std::min(all.size(), kMaxNodes));
  return all;
}

/// Returns nodes relative to each other, the first relative to `reference`. Each is rounded separately, so errors do
/// not accumulate. The first point must be within reach of `reference`.
std::vector<v2x::Node> nodes_of(std::span<const glm::dvec2> points, glm::dvec2 reference) {
  std::vector<v2x::Node> nodes;
  std::int32_t x = 0, y = 0;
  for (const glm::dvec2& p : within_reach(points)) {
    const std::int32_t next_x = centimetres(p.x - reference.x), next_y = centimetres(p.y - reference.y);
    const std::int32_t far = std::max(std::abs(next_x - x), std::abs(next_y - y));
    v2x::NodeOffset& delta = nodes.emplace_back().delta;
    delta.choice =
        static_cast<v2x::NodeOffset::Alternative>(std::lower_bound(kReach.begin(), kReach.end(), far) - kReach.begin());
    delta.xy = {next_x - x, next_y - y};
    x = next_x;
    y = next_y;
  }
  return nodes;
}

/// Returns at least two way-points from `from`, in or against the driving direction.
std::vector<glm::dvec2> way_of(const RoadNetwork& roads, PointRef from, bool forwards) {
  const world::RoadLane& lane = roads.lanes[from.row];
  std::vector<glm::dvec2> points;
  const auto last = static_cast<std::int64_t>(lane.points.size());
  for (std::int64_t i = from.index; i >= 0 && i < last; i += forwards ? 1 : -1) points.push_back(lane.points[i].p);
  if (points.size() == 1) {
    const double step = forwards ? lane.width : -lane.width;
    points.push_back(points[0] + base::rotate(lane.points[from.index].yaw, {step, 0.0}));
  }
  return points;
}

std::uint16_t maneuver_of(double turn) {
  const double angle = base::wrap_angle(turn) * 180.0 / M_PI;
  const unsigned bit = std::abs(angle) < 45.0 ? 0 : std::abs(angle) > 135.0 ? 3 : angle > 0.0 ? 1 : 2;
  return static_cast<std::uint16_t>(1u << (11 - bit));
}

class MapBuilder {
 public:
  MapBuilder(const RoadNetwork& roads, const Intersection& intersection) : roads_(roads), intersection_(intersection) {
    for (const PointRef& stop : intersection.stops) reference_ += position_of(roads, stop);
    reference_ /= static_cast<double>(intersection.stops.size());
  }

  v2x::MapData build(world::Geodetic origin) {
    v2x::MapData map;
    map.layer = 3;  // intersectionData
    map.layer_id = 0;
    v2x::IntersectionGeometry& geometry = map.intersections.emplace_back();
    geometry.id.id = intersection_.id;
    const world::Geodetic at = geodetic_of(reference_, origin);
    geometry.reference.latitude = static_cast<std::int32_t>(std::lround(1e7 * at.latitude));
    geometry.reference.longitude = wrapped_longitude(at.longitude);
    const double width = roads_.lanes[intersection_.stops[0].row].width;
    geometry.lane_width = static_cast<std::uint16_t>(std::clamp(centimetres(width), 0, 32'767));
    for (std::size_t i = 0; i < intersection_.stops.size(); ++i) add_ingress(i);
    for (const auto& [to, id] : egress_) add_lane(id, kEgress, to);
    if (lanes_.size() > kMaxLanes)
      throw base::InputError(roads_.file, 0,
                             fmt::format("intersection {} has {} lanes; a MAP message holds {}", intersection_.id,
                                         lanes_.size(), kMaxLanes));
    geometry.lanes = std::move(lanes_);
    return map;
  }

 private:
  v2x::GenericLane& add_lane(std::size_t id, std::uint8_t direction, PointRef from) {
    v2x::GenericLane& lane = lanes_.emplace_back();
    lane.id = static_cast<std::uint8_t>(id);
    lane.attributes.direction = direction;
    const glm::dvec2 p = position_of(roads_, from) - reference_;
    if (std::max(std::abs(p.x), std::abs(p.y)) > kNodeReach)
      throw base::InputError(roads_.file, 0,
                             fmt::format("lanes of intersection {} are more than {} m from its middle, "
                                         "as far as a MAP message reaches",
                                         intersection_.id, kNodeReach));
    lane.nodes.nodes = nodes_of(way_of(roads_, from, direction == kEgress), reference_);
    return lane;
  }

  void add_ingress(std::size_t row) {
    const PointRef stop = intersection_.stops[row];
    v2x::GenericLane& lane = add_lane(row + 1, kIngress, stop);
    if (row < 15) lane.ingress_approach = static_cast<std::uint8_t>(row + 1);
    std::uint16_t maneuvers = 0;
    for (const world::RoadExit& exit : roads_.exits) {
      if (exit.from != stop || exit.to.kind != PointRef::Kind::lane || lane.connections.size() == kMaxConnections)
        continue;
      v2x::Connection& connection = lane.connections.emplace_back();
      connection.to.lane = static_cast<std::uint8_t>(egress_lane(exit.to));
      connection.to.maneuver = maneuver_of(yaw_of(roads_, exit.to).value_or(0.0) - yaw_of(roads_, stop).value_or(0.0));
      connection.signal_group = static_cast<std::uint8_t>(intersection_.groups[row]);
      if (connections_ < 255) connection.id = ++connections_;
      maneuvers |= *connection.to.maneuver;
    }
    lane.maneuvers = maneuvers;
  }

  /// Ids of egress lanes follow those of the ingress lanes.
  std::size_t egress_lane(PointRef to) {
    const auto found = std::find_if(egress_.begin(), egress_.end(), [&](const auto& one) { return one.first == to; });
    if (found != egress_.end()) return found->second;
    egress_.emplace_back(to, intersection_.stops.size() + egress_.size() + 1);
    return egress_.back().second;
  }

  const RoadNetwork& roads_;
  const Intersection& intersection_;
  glm::dvec2 reference_;
  std::vector<v2x::GenericLane> lanes_;
  std::vector<std::pair<PointRef, std::size_t>> egress_;
  std::uint8_t connections_ = 0;  ///< connections with an id
};

}  // namespace

std::optional<v2x::MapData> map_of(const RoadNetwork& roads, const Intersection& intersection, world::Geodetic origin) {
  if (intersection.stops.empty()) return std::nullopt;
  return MapBuilder(roads, intersection).build(origin);
}

}  // namespace sf::server
