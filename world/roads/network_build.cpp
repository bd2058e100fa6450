// Converts degrees and feet to the tables of a RoadNetwork.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "world/roads/lane_markings.h"
#include "world/roads/network.h"

namespace sf::world {

namespace {

constexpr double kLaneWidthFt = 12.0;          // default: the lane width of US highways
constexpr double kSpotWidthFt = 9.0;           // default: a common US parking stall
constexpr double kFar = 20e3;                  // [m] from the origin; flattening causes 3 cm there
constexpr std::size_t kMaxSamples = 1u << 20;  // points of all centre lines
constexpr std::size_t kMaxExitSamples = 4 * kMaxSamples;

struct Builder {
  const Rndf& rndf;
  const RoadSidecar& sidecar;
  std::vector<Warning>& warnings;
  LocalPlane plane;
  RoadNetwork network;
  std::size_t samples = 0;
  bool warned_far = false;

  void warn(int line, std::string message) { warnings.push_back({rndf.file, line, std::move(message)}); }

  glm::dvec2 place(const RndfPoint& point) {
    if (const auto own = sidecar.points.find(point.id); own != sidecar.points.end() && own->second.p)
      return *own->second.p;
    const glm::dvec2 flat = plane.east_north({point.latitude, point.longitude});
    if (!warned_far && length(flat) > kFar) {
      warned_far = true;
      warn(point.line,
           fmt::format("{} is {:.0f} km from the origin; distances are too short there (check the degrees, or "
                       "set 'origin' in the sidecar)",
                       point_id_text(point.id), length(flat) / 1000.0));
    }
    return sidecar.position + base::rotate(sidecar.heading, sidecar.scale * flat);
  }
};

Geodetic origin_of(const Rndf& rndf, const RoadSidecar& sidecar) {
  if (sidecar.origin) return *sidecar.origin;
  for (const RndfSegment& segment : rndf.segments)
    for (const RndfLane& lane : segment.lanes)
      if (!lane.points.empty()) return {lane.points[0].latitude, lane.points[0].longitude};
  return {};
}

double lane_width(Builder& b, const RndfSegment& segment, const RndfLane& lane, const RoadSidecar::Lane& own) {
  if (own.width) return *own.width;
  if (b.sidecar.lane_width) return *b.sidecar.lane_width;
  if (!lane.width_ft)
    b.warn(lane.line,
           fmt::format("lane {}.{} has no lane_width; assuming {} ft", segment.id, lane.number, kLaneWidthFt));
  return lane.width_ft.value_or(kLaneWidthFt) * kFoot * b.sidecar.scale;
}

void trace_lane(Builder& b, RoadLane& lane, const RndfLane& from) {
  std::vector<glm::dvec2> waypoints;
  for (const RndfPoint& point : from.points) waypoints.push_back(b.place(point));
  for (std::size_t i = 1; i < waypoints.size(); ++i)
    if (length(waypoints[i] - waypoints[i - 1]) < 1e-6)
      b.warn(from.points[i].line, fmt::format("way-points {} and {} coincide", point_id_text(from.points[i - 1].id),
                                              point_id_text(from.points[i].id)));
  lane.centre = smooth_curve(waypoints, {b.network.tolerance, 0.5 * lane.width, kMaxSamples - b.samples});
  b.samples += lane.centre.points.size();
  if (b.samples >= kMaxSamples)
    throw base::InputError(
        b.rndf.file, from.line,
        fmt::format("its lanes require more than {} points; check the coordinates or split the network", kMaxSamples));
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    const std::size_t knot = lane.centre.knots[i];
    const glm::dvec2 tangent = lane.centre.tangents[knot];
    const auto own = b.sidecar.points.find(from.points[i].id);
    lane.points.push_back({from.points[i].id, waypoints[i], lane.centre.s[knot], base::atan2(tangent.y, tangent.x),
                           own == b.sidecar.points.end() ? 0.0 : own->second.height});
  }
}

void add_lane(Builder& b, const RndfSegment& segment, const RndfLane& from) {
  const PointId id{static_cast<std::uint16_t>(segment.id), static_cast<std::uint16_t>(from.number), 0};
  const auto found = b.sidecar.lanes.find(id);
  const RoadSidecar::Lane own = found == b.sidecar.lanes.end() ? RoadSidecar::Lane{} : found->second;
  RoadLane lane;
  lane.segment = static_cast<std::uint32_t>(b.network.segments.size() - 1);
  lane.number = from.number;
  lane.width = lane_width(b, segment, from, own);
  lane.left = own.left.value_or(from.left);
  lane.right = own.right.value_or(from.right);
  trace_lane(b, lane, from);
  lane.left_edge = offset_curve(lane.centre, 0.5 * lane.width);
  lane.right_edge = offset_curve(lane.centre, -0.5 * lane.width);
  if (lane.centre.points.size() < 2)
    b.warn(from.line, fmt::format("lane {}.{} has one point only: no direction, no edges and no markings", segment.id,
                                  from.number));
  b.network.lanes.push_back(std::move(lane));
}

void add_segments(Builder& b) {
  for (const RndfSegment& segment : b.rndf.segments) {
    b.network.segments.push_back({segment.id, segment.name, static_cast<std::uint32_t>(b.network.lanes.size()),
                                  static_cast<std::uint32_t>(segment.lanes.size())});
    for (const RndfLane& lane : segment.lanes) add_lane(b, segment, lane);
  }
}

void add_zone(Builder& b, const RndfZone& from) {
  RoadZone zone{from.id,
                from.name,
                {},
                static_cast<std::uint32_t>(b.network.spots.size()),
                static_cast<std::uint32_t>(from.spots.size())};
  for (const RndfPoint& point : from.perimeter) zone.perimeter.push_back({point.id, b.place(point)});
  const auto row = static_cast<std::uint32_t>(b.network.zones.size());
  for (const RndfSpot& spot : from.spots) {
    if (!spot.width_ft && !b.sidecar.spot_width)
      b.warn(spot.line,
             fmt::format("spot {}.{} has no spot_width; assuming {} ft", from.id, spot.number, kSpotWidthFt));
    const double width = spot.width_ft.value_or(kSpotWidthFt) * kFoot * b.sidecar.scale;
    b.network.spots.push_back(
        {row, spot.number, b.sidecar.spot_width.value_or(width), b.place(spot.points[0]), b.place(spot.points[1])});
  }
  b.network.zones.push_back(std::move(zone));
}

void build_index(RoadNetwork& network) {
  const auto add = [&](PointRef at) { network.index.emplace_back(id_of(network, at), at); };
  for (std::uint32_t row = 0; row < network.lanes.size(); ++row)
    for (std::uint32_t i = 0; i < network.lanes[row].points.size(); ++i) add({PointRef::Kind::lane, row, i});
  for (std::uint32_t row = 0; row < network.zones.size(); ++row)
    for (std::uint32_t i = 0; i < network.zones[row].perimeter.size(); ++i) add({PointRef::Kind::perimeter, row, i});
  for (std::uint32_t row = 0; row < network.spots.size(); ++row)
    for (std::uint32_t i = 0; i < 2; ++i) add({PointRef::Kind::spot, row, i});
  std::sort(network.index.begin(), network.index.end(), [](const auto& a, const auto& c) { return a.first < c.first; });
}

PointRef need(const RoadNetwork& network, PointId id) {
  const auto found = find_point(network, id);
  SF_CHECK(found.has_value(), "a checked RNDF names " + point_id_text(id) + ", which it does not have");
  return *found;
}

void add_exits(RoadNetwork& network, const std::vector<RndfExit>& exits) {
  for (const RndfExit& exit : exits) network.exits.push_back({need(network, exit.from), need(network, exit.to), 0.0});
}

void add_checkpoints(RoadNetwork& network, const std::vector<RndfCheckpoint>& checkpoints) {
  for (const RndfCheckpoint& checkpoint : checkpoints) {
    const PointRef at = need(network, checkpoint.at);
    network.checkpoints.push_back({checkpoint.id, at, position_of(network, at)});
  }
}

void add_stop(RoadNetwork& network, const RndfStop& stop) {
  const PointRef at = need(network, stop.at);
  const RoadLane& lane = network.lanes[at.row];
  if (lane.centre.points.size() < 2) return;
  const LanePoint& point = lane.points[at.index];
  const glm::dvec2 half = base::rotate(point.yaw, {0.0, 0.5 * lane.width});
  network.stops.push_back({at, point.p + half, point.p - half, stop.at});
}

void join(Builder& b) {
  RoadNetwork& network = b.network;
  for (const RndfSegment& segment : b.rndf.segments)
    for (const RndfLane& lane : segment.lanes) {
      add_exits(network, lane.exits);
      add_checkpoints(network, lane.checkpoints);
      for (const RndfStop& stop : lane.stops) add_stop(network, stop);
    }
  for (const RndfZone& zone : b.rndf.zones) {
    add_exits(network, zone.exits);
    for (const RndfSpot& spot : zone.spots) add_checkpoints(network, spot.checkpoints);
  }
  const auto key = [](const RoadExit& exit) { return std::tuple(exit.from.kind, exit.from.row, exit.from.index); };
  std::stable_sort(network.exits.begin(), network.exits.end(),
                   [&](const RoadExit& x, const RoadExit& y) { return key(x) < key(y); });
  std::size_t samples = 0;
  for (RoadExit& exit : network.exits) {
    const Curve way = exit_curve(network, exit);
    exit.length = way.s.back();
    samples += way.points.size();
    if (samples > kMaxExitSamples)
      throw base::InputError(
          b.rndf.file, 0,
          fmt::format("its exits require more than {} points; check the coordinates or split the network",
                      kMaxExitSamples));
  }
  std::sort(network.checkpoints.begin(), network.checkpoints.end(),
            [](const RoadCheckpoint& x, const RoadCheckpoint& y) { return x.id < y.id; });
}

Extent extent_of(const RoadNetwork& network) {
  Extent e{INFINITY, INFINITY, -INFINITY, -INFINITY};
  const auto add = [&](glm::dvec2 p) {
    e = {std::min(e.x_min, p.x), std::min(e.y_min, p.y), std::max(e.x_max, p.x), std::max(e.y_max, p.y)};
  };
  for (const RoadLane& lane : network.lanes)
    for (const auto* line : {&lane.centre.points, &lane.left_edge, &lane.right_edge})
      for (const glm::dvec2& p : *line) add(p);
  for (const RoadZone& zone : network.zones)
    for (const PerimeterPoint& point : zone.perimeter) add(point.p);
  for (const RoadSpot& spot : network.spots) add(spot.entry), add(spot.end);
  return e;
}

MarkingSizes marking_sizes(const RoadSidecar& sidecar) {
  return {sidecar.paint_width.value_or(4.0 * kInch * sidecar.scale),
          sidecar.dash_length.value_or(10.0 * kFoot * sidecar.scale),
          sidecar.dash_gap.value_or(30.0 * kFoot * sidecar.scale),
          sidecar.stop_width.value_or(12.0 * kInch * sidecar.scale)};
}

}  // namespace

RoadNetwork build_network(const Rndf& rndf, const RoadSidecar& sidecar, std::vector<Warning>& warnings) {
  check_against(sidecar, rndf);
  Builder b{rndf, sidecar, warnings, LocalPlane(origin_of(rndf, sidecar)), {}};
  b.network.name = rndf.name;
  b.network.file = rndf.file;
  b.network.scale = sidecar.scale;
  // 1 mm on the real road, but at most 0.1 mm for scaled-down networks.
  b.network.tolerance = sidecar.scale < 1.0 ? std::min(1e-3 * sidecar.scale, 1e-4) : 1e-3 * sidecar.scale;
  b.network.paint = marking_sizes(sidecar);
  b.network.counts = count(rndf);
  add_segments(b);
  for (const RndfZone& zone : rndf.zones) add_zone(b, zone);
  build_index(b.network);
  join(b);
  b.network.extent = extent_of(b.network);
  return std::move(b.network);
}

}  // namespace sf::world
