#include "world/roads/lane_markings.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace sf::world {

namespace {

constexpr std::size_t kMaxLaneMarkings = 1'000'000;
constexpr double kShortest = 1e-9;  // [m]

struct Painter {
  const RoadNetwork& network;
  std::vector<LaneMarking> lane_markings;
  std::vector<MarkingHeights> heights = {};

  /// Gives heights to the markings that were added since the last call.
  void end_part(const MarkingHeights& of) { heights.resize(lane_markings.size(), of); }

  // A marking turns by less than 90 degrees at each point, so a sharper line is split into two markings.
  void add(std::vector<glm::dvec2> line, double width, std::uint32_t color) {
    if (lane_markings.size() >= kMaxLaneMarkings)
      throw base::InputError(network.file, 0,
                             fmt::format("more than {} painted lines and dashes; check its coordinates, or its "
                                         "sidecar's dash_length_m",
                                         kMaxLaneMarkings));
    std::size_t from = 0;
    for (std::size_t i = 1; i + 1 < line.size(); ++i) {
      if (dot(line[i] - line[i - 1], line[i + 1] - line[i]) > 0.0) continue;
      lane_markings.push_back(
          {{line.begin() + static_cast<std::ptrdiff_t>(from), line.begin() + static_cast<std::ptrdiff_t>(i) + 1},
           width,
           color});
      from = i;
    }
    line.erase(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(from));
    if (line.size() >= 2) lane_markings.push_back({std::move(line), width, color});
  }
};

/// Returns the part of `line` from `begin` to `end` [m] along it.
std::vector<glm::dvec2> part_of(const std::vector<glm::dvec2>& line, const std::vector<double>& s, double begin,
                                double end) {
  std::vector<glm::dvec2> part;
  const auto add = [&](glm::dvec2 p) {
    if (part.empty() || length(p - part.back()) > kShortest) part.push_back(p);
  };
  const auto at = [&](double where) {
    const auto next = std::upper_bound(s.begin(), s.end() - 1, where);
    const auto i = static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - s.begin(), 1));
    return line[i - 1] + (where - s[i - 1]) / (s[i] - s[i - 1]) * (line[i] - line[i - 1]);
  };
  add(at(begin));
  auto i = static_cast<std::size_t>(std::upper_bound(s.begin(), s.end(), begin) - s.begin());
  for (; i < s.size() && s[i] < end; ++i) add(line[i]);
  add(at(end));
  return part;
}

void add_dashes(Painter& painter, const std::vector<glm::dvec2>& line) {
  std::vector<double> s{0.0};
  for (std::size_t i = 1; i < line.size(); ++i) s.push_back(s.back() + length(line[i] - line[i - 1]));
  const MarkingSizes& paint = painter.network.paint;
  const double period = paint.dash_length + paint.dash_gap;
  for (double k = 0.0; k * period < s.back() - kShortest; k += 1.0) {
    const double begin = k * period;
    auto dash = part_of(line, s, begin, std::min(begin + paint.dash_length, s.back()));
    if (dash.size() >= 2) painter.add(std::move(dash), paint.line_width, kWhitePaint);
  }
}

/// @param side 1: left, -1: right
void add_edge(Painter& painter, const RoadLane& lane, Boundary boundary, double side) {
  const std::vector<glm::dvec2>& edge = side > 0.0 ? lane.left_edge : lane.right_edge;
  const double width = painter.network.paint.line_width;
  if (edge.size() < 2) return;
  switch (boundary) {
    case Boundary::none:
      return;
    case Boundary::solid_white:
      return painter.add(edge, width, kWhitePaint);
    case Boundary::solid_yellow:
      return painter.add(edge, width, kYellowPaint);
    case Boundary::broken_white:
      return add_dashes(painter, edge);
    case Boundary::double_yellow:
      break;
  }
  for (const double by : {width, -width}) {
    auto line = offset_curve(lane.centre, side * 0.5 * lane.width + by);
    if (line.size() >= 2) painter.add(std::move(line), width, kYellowPaint);
  }
}

void add_spot(Painter& painter, const RoadSpot& spot) {
  const glm::dvec2 along = spot.end - spot.entry;
  const double depth = length(along);
  if (depth < kShortest) return;
  const glm::dvec2 half = (0.5 * spot.width / depth) * glm::dvec2{-along.y, along.x};
  const double width = painter.network.paint.line_width;
  painter.add({spot.entry + half, spot.end + half}, width, kWhitePaint);
  painter.add({spot.entry - half, spot.end - half}, width, kWhitePaint);
  painter.add({spot.end + half, spot.end - half}, width, kWhitePaint);
}

}  // namespace

std::vector<LaneMarking> lane_markings_of(const RoadNetwork& network, std::vector<MarkingHeights>* heights) {
  Painter painter{network, {}};
  for (const RoadLane& lane : network.lanes) {
    add_edge(painter, lane, lane.left, 1.0);
    add_edge(painter, lane, lane.right, -1.0);
    if (lane.points.empty()) continue;  // a lane of edges alone
    const auto [low, high] = std::ranges::minmax(lane.points, {}, &LanePoint::z);
    painter.end_part({low.z, high.z});
  }
  for (const StopLine& stop : network.stops) {
    painter.add({stop.left, stop.right}, network.paint.stop_width, kWhitePaint);
    const double z = network.lanes[stop.at.row].points[stop.at.index].z;
    painter.end_part({z, z});
  }
  for (const RoadSpot& spot : network.spots) add_spot(painter, spot);
  painter.end_part({});
  if (heights != nullptr) *heights = std::move(painter.heights);
  return std::move(painter.lane_markings);
}

}  // namespace sf::world
