#include "viz/road_view.h"

#include <algorithm>

#include "viz/color.h"
#include "viz/theme.h"
#include "world/roads/lane_markings.h"

namespace sf::viz {
namespace {

using world::RoadLane;
using world::RoadNetwork;
using world::RoadZone;

constexpr double kArrowEvery = 70.0;    // [px] along a lane
constexpr double kThinnestPaint = 1.3;  // [px]

void draw_zone(const RoadView& view, const RoadNetwork& network, const RoadZone& zone) {
  std::vector<glm::dvec2> outline;
  for (const world::PerimeterPoint& point : zone.perimeter) outline.push_back(view.pixel(point.p));
  view.canvas.polygon(outline, theme::kZone);
  outline.push_back(outline.front());
  view.canvas.polyline(outline, theme::kOutline, theme::kZoneEdge);
  for (std::uint32_t i = 0; i < zone.spots; ++i) {
    const world::RoadSpot& spot = network.spots[zone.first_spot + i];
    const glm::dvec2 along = spot.end - spot.entry;
    const double depth = length(along);
    if (depth <= 0.0) continue;
    const glm::dvec2 half = (0.5 * spot.width / depth) * glm::dvec2{-along.y, along.x};
    const glm::dvec2 corners[] = {view.pixel(spot.entry + half), view.pixel(spot.end + half),
                                  view.pixel(spot.end - half), view.pixel(spot.entry - half)};
    view.canvas.polygon(corners, theme::kSpot);
  }
}

void draw_asphalt(const RoadView& view, const RoadLane& lane) {
  if (lane.left_edge.empty() || lane.right_edge.empty()) return;
  std::vector<glm::dvec2> outline = pixels(view, lane.left_edge);
  const std::vector<glm::dvec2> back = pixels(view, lane.right_edge);
  outline.insert(outline.end(), back.rbegin(), back.rend());
  view.canvas.polygon(outline, theme::kAsphalt);
}

void draw_edges(const RoadView& view, const RoadLane& lane) {
  view.canvas.polyline(pixels(view, lane.left_edge), theme::kHairline, theme::kLaneEdge);
  view.canvas.polyline(pixels(view, lane.right_edge), theme::kHairline, theme::kLaneEdge);
}

// The markings include stop lines, which are drawn over later in their own colour.
void draw_lane_markings(const RoadView& view, const RoadNetwork& network) {
  for (const world::LaneMarking& marking : world::lane_markings_of(network))
    view.canvas.polyline(pixels(view, marking.line), std::max(marking.width * view.scale, kThinnestPaint),
                         marking.color);
}

// ------------------------------------------------------------------------------------------------- marks

void draw_arrow(Canvas& canvas, glm::dvec2 at, glm::dvec2 along, double size, std::uint32_t color) {
  const glm::dvec2 across{-along.y, along.x};
  const glm::dvec2 corners[] = {at + size * along, at - size * along + (0.8 * size) * across,
                                at - (0.45 * size) * along, at - size * along - (0.8 * size) * across};
  canvas.polygon(corners, color);
}

void draw_directions(const RoadView& view, const RoadLane& lane) {
  const double total = length_of(lane);
  const double size = std::clamp(0.36 * lane.width * view.scale, 2.2, 10.0);
  if (total * view.scale < 2.5 * size || lane.centre.points.size() < 2) return;
  const int arrows = std::max(1, static_cast<int>(total * view.scale / kArrowEvery));
  for (int k = 0; k < arrows; ++k) {
    const double s = total * (k + 0.5) / arrows;
    const double step = std::min(0.25 * total, size / view.scale);
    const glm::dvec2 d = view.pixel(point_at(lane.centre, s + step)) - view.pixel(point_at(lane.centre, s - step));
    if (length(d) > 0.0)
      draw_arrow(view.canvas, view.pixel(point_at(lane.centre, s)), (1.0 / length(d)) * d, size, theme::kWhite);
  }
}

void draw_exits(const RoadView& view, const RoadNetwork& network) {
  for (const world::RoadExit& exit : network.exits) {
    const auto line = pixels(view, exit_curve(network, exit).points);
    if (line.size() < 2) continue;
    view.canvas.polyline(line, 1.6, theme::kExit);
    const glm::dvec2 d = line.back() - line[line.size() - 2];
    if (length(d) > 0.0 && length(line.back() - line.front()) > 12.0)
      draw_arrow(view.canvas, line.back() - (4.0 / length(d)) * d, (1.0 / length(d)) * d, 4.0,
                 with_opacity(theme::kExit, 0.9));
  }
}

void draw_stops(const RoadView& view, const RoadNetwork& network) {
  for (const world::StopLine& stop : network.stops)
    view.canvas.line(view.pixel(stop.left), view.pixel(stop.right),
                     std::max(network.paint.stop_width * view.scale, 3.0), theme::kStop);
}

void draw_checkpoints(const RoadView& view, const RoadNetwork& network) {
  for (const world::RoadCheckpoint& checkpoint : network.checkpoints) {
    view.canvas.disc(view.pixel(checkpoint.p), 4.2, theme::kWhite);
    view.canvas.disc(view.pixel(checkpoint.p), 3.2, theme::kCheckpoint);
  }
}

}  // namespace

std::vector<glm::dvec2> pixels(const RoadView& view, const std::vector<glm::dvec2>& line) {
  std::vector<glm::dvec2> out;
  out.reserve(line.size());
  for (const glm::dvec2& p : line) out.push_back(view.pixel(p));
  return out;
}

void draw_network(const RoadView& view, const RoadNetwork& network) {
  for (const RoadZone& zone : network.zones) draw_zone(view, network, zone);
  for (const RoadLane& lane : network.lanes) draw_asphalt(view, lane);
  for (const RoadLane& lane : network.lanes) draw_edges(view, lane);
  draw_lane_markings(view, network);
  for (const RoadLane& lane : network.lanes) draw_directions(view, lane);
  draw_exits(view, network);
  draw_stops(view, network);
  draw_checkpoints(view, network);
}

}  // namespace sf::viz
