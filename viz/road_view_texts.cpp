// Texts of a road network: names and checkpoint ids.

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "viz/legend.h"
#include "viz/road_view.h"
#include "viz/theme.h"

namespace sf::viz {
namespace {

using world::RoadLane;
using world::RoadNetwork;
using world::RoadZone;

constexpr std::size_t kLongestName = 32;
constexpr double kShortestNamed = 45.0;  // [px] of a street
constexpr std::uint32_t kMaxLanes = 8;   // number of lanes of a segment that are tried for its name

bool is_in(const DetailViews& places, glm::dvec2 p) {
  return std::any_of(places.begin(), places.end(), [&](const world::Extent& e) {
    return p.x > e.x_min && p.x < e.x_max && p.y > e.y_min && p.y < e.y_max;
  });
}

bool is_inside(const PixelBox& box, glm::dvec2 p) {
  return p.x > box.x_min && p.x < box.x_max && p.y > box.y_min && p.y < box.y_max;
}

TextStyle label_style(int size, std::uint32_t color, bool bold) {
  TextStyle style = small_text();
  style.size = size;
  style.color = color;
  style.bold = bold;
  style.halo = theme::kWhite;
  return style;
}

/// Places a name next to one of several points along the segment.
void label_segments(const RoadView& view, const RoadNetwork& network, Labels& labels, const DetailViews& elsewhere) {
  const TextStyle style = label_style(15, theme::kInk, true);
  for (const world::RoadSegment& segment : network.segments) {
    std::vector<glm::dvec2> marks;
    for (std::uint32_t i = 0; i < std::min(segment.lanes, kMaxLanes); ++i) {
      const RoadLane& lane = network.lanes[segment.first_lane + i];
      for (const double part : {0.5, 0.35, 0.65, 0.2, 0.8}) {
        const glm::dvec2 p = point_at(lane.centre, part * length_of(lane));
        if (!is_in(elsewhere, p) && is_inside(view.box, view.pixel(p))) marks.push_back(view.pixel(p));
      }
    }
    const std::string number = std::to_string(segment.id);
    bool named = !segment.name.empty() && segment.name != number;
    // On a short street, the full name could be mistaken for a neighbour's.
    double longest = 0.0;
    for (std::uint32_t i = 0; i < segment.lanes; ++i)
      longest = std::max(longest, length_of(network.lanes[segment.first_lane + i]) * view.scale);
    named = named && longest > kShortestNamed;
    const std::string whole = named ? number + " " + printable(segment.name, kLongestName) : number;
    const LabelRules rules{7.0, 90.0, 22.0, 1.0};
    if (!labels.place(view.canvas, marks, whole, style, rules)) labels.place(view.canvas, marks, number, style, rules);
  }
}

void label_zones(const RoadView& view, const RoadNetwork& network, Labels& labels, const DetailViews& elsewhere) {
  const TextStyle style = label_style(17, theme::kZoneText, true);
  for (const RoadZone& zone : network.zones) {
    glm::dvec2 middle;
    for (const world::PerimeterPoint& point : zone.perimeter)
      middle = middle + (1.0 / static_cast<double>(zone.perimeter.size())) * point.p;
    if (is_in(elsewhere, middle)) continue;
    const glm::dvec2 marks[] = {view.pixel(middle)};
    const std::string name = printable(zone.name, kLongestName);
    labels.place(view.canvas, marks,
                 fmt::format("{} {}", name.empty() ? "zone" : std::to_string(zone.id),
                             name.empty() ? std::to_string(zone.id) : name),
                 style, {0.0, 250.0, 120.0, 2.0});
  }
}

void label_checkpoints(const RoadView& view, const RoadNetwork& network, Labels& labels, const DetailViews& elsewhere) {
  const TextStyle style = label_style(12, theme::kCheckpoint, true);
  for (const bool on_lanes : {true, false})
    for (const world::RoadCheckpoint& checkpoint : network.checkpoints) {
      if ((checkpoint.at.kind == world::PointRef::Kind::lane) != on_lanes || is_in(elsewhere, checkpoint.p)) continue;
      const glm::dvec2 marks[] = {view.pixel(checkpoint.p)};
      labels.place(view.canvas, marks, std::to_string(checkpoint.id), style, {5.0, on_lanes ? 40.0 : 32.0, 14.0, 0.5});
    }
}

}  // namespace

std::string printable(const std::string& name, std::size_t most) {
  std::string text;
  for (const char c : name.substr(0, most)) text += c >= ' ' && c < '\x7f' ? c : '?';
  return name.size() > most ? text + "..." : text;
}

void avoid_network(const RoadView& view, const RoadNetwork& network, Labels& labels) {
  for (const RoadLane& lane : network.lanes) labels.avoid(pixels(view, lane.centre.points), lane.width * view.scale);
  for (const world::RoadSpot& spot : network.spots)
    labels.avoid(pixels(view, {spot.entry, spot.end}), spot.width * view.scale);
  for (const world::RoadCheckpoint& checkpoint : network.checkpoints)
    labels.avoid(pixels(view, {checkpoint.p, checkpoint.p}), 8.0);
}

void draw_texts(const RoadView& view, const RoadNetwork& network, Labels& labels, const DetailViews& elsewhere) {
  label_segments(view, network, labels, elsewhere);
  label_checkpoints(view, network, labels, elsewhere);
  label_zones(view, network, labels, elsewhere);
}

}  // namespace sf::viz
