#include "viz/road_layer.h"

#include <algorithm>
#include <cmath>

#include "viz/theme.h"
#include "world/path_geometry.h"

namespace sf::viz {

namespace {

using world::LaneMarking;

constexpr double kShoulder = 7.0;   // [px] asphalt on each side of a marking
constexpr double kThinnest = 1.3;   // [px] smallest width of a marking
constexpr double kLaneStep = 0.02;  // [m] along a lane

/// Markings have square ends but canvas lines have round ones, so each piece is drawn as a quadrilateral.
void add_band(Axes& axes, const LaneMarking& marking, std::vector<Line>& edges) {
  const double half = 0.5 * std::max(marking.width, kThinnest / axes.scale());
  for (std::size_t i = 0; i + 1 < marking.line.size(); ++i) {
    const glm::dvec2 along = marking.line[i + 1] - marking.line[i];
    const glm::dvec2 aside = half / glm::length(along) * glm::dvec2{-along.y, along.x};
    const glm::dvec2 corners[] = {axes.pixel(marking.line[i] + aside), axes.pixel(marking.line[i] - aside),
                                  axes.pixel(marking.line[i + 1] - aside), axes.pixel(marking.line[i + 1] + aside)};
    for (int k = 0; k < 4; ++k) edges.push_back({corners[k], corners[(k + 1) % 4]});
  }
}

/// Draws all lanes of the world's paths, from edge to edge.
void draw_lanes(Axes& axes, const world::World& world) {
  std::vector<Line> edges;
  for (const world::Path& path : world.paths)
    for (const world::PathPiece& piece : path.pieces) {
      const int steps = std::max(1, static_cast<int>(std::ceil(piece.length / kLaneStep)));
      const auto corner = [&](int step, double side) {
        const base::Pose X_WP = world::pose_at(piece, piece.length * step / steps);
        return axes.pixel(base::transform(X_WP, {0.0, 0.5 * side * piece.width}));
      };
      for (int i = 0; i < steps; ++i) {
        const glm::dvec2 corners[] = {corner(i, 1.0), corner(i, -1.0), corner(i + 1, -1.0), corner(i + 1, 1.0)};
        for (int k = 0; k < 4; ++k) edges.push_back({corners[k], corners[(k + 1) % 4]});
      }
    }
  if (!edges.empty()) axes.canvas().area(edges, theme::kAsphaltBand);
}

}  // namespace

void draw_lane_markings(Axes& axes, const world::World& world) {
  if (world.lane_markings.empty()) return;
  std::vector<Line> asphalt;
  double widest = 0.0;
  for (const LaneMarking& marking : world.lane_markings) {
    widest = std::max(widest, marking.width * axes.scale());
    for (std::size_t i = 0; i + 1 < marking.line.size(); ++i)
      asphalt.push_back({axes.pixel(marking.line[i]), axes.pixel(marking.line[i + 1])});
  }
  axes.canvas().lines(asphalt, widest + 2.0 * kShoulder, theme::kAsphaltBand);
  draw_lanes(axes, world);

  std::vector<std::uint32_t> colors;
  for (const LaneMarking& marking : world.lane_markings) colors.push_back(marking.color);
  std::sort(colors.begin(), colors.end());
  colors.erase(std::unique(colors.begin(), colors.end()), colors.end());
  for (const std::uint32_t color : colors) {
    std::vector<Line> edges;
    for (const LaneMarking& marking : world.lane_markings)
      if (marking.color == color) add_band(axes, marking, edges);
    axes.canvas().area(edges, color);
  }
}

void draw_streets(Axes& axes, const world::RoadNetwork& roads) {
  for (const world::RoadZone& zone : roads.zones) {
    std::vector<glm::dvec2> outline;
    for (const world::PerimeterPoint& point : zone.perimeter) outline.push_back(axes.pixel(point.p));
    axes.canvas().polygon(outline, theme::kAsphaltBand);
  }
  std::vector<Line> bands;
  double widest = 0.0;
  const auto add = [&](const std::vector<glm::dvec2>& line) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) bands.push_back({axes.pixel(line[i]), axes.pixel(line[i + 1])});
  };
  for (const world::RoadLane& lane : roads.lanes) {
    add(lane.centre.points);
    widest = std::max(widest, lane.width);
  }
  for (const world::RoadExit& exit : roads.exits) add(exit_curve(roads, exit).points);
  if (widest > 0.0) axes.canvas().lines(bands, widest * axes.scale(), theme::kAsphaltBand);
}

void draw_magnets(Axes& axes, const world::World& world) {
  for (const world::Magnet& magnet : world.magnets) {
    const double radius = std::clamp(magnet.radius * axes.scale(), 0.8, 6.0);
    axes.canvas().disc(axes.pixel(magnet.p), radius, magnet.moment > 0.0 ? theme::kMagnetUp : theme::kMagnetDown);
  }
}

std::vector<LegendItem> road_legend(const world::World& world) {
  std::vector<LegendItem> items;
  if (!world.lane_markings.empty()) items.push_back({LegendMark::block, theme::kAsphaltBand, "road with markings"});
  const auto has = [&](bool north) {
    return std::any_of(world.magnets.begin(), world.magnets.end(),
                       [&](const world::Magnet& m) { return (m.moment > 0.0) == north; });
  };
  if (has(true)) items.push_back({LegendMark::dot, theme::kMagnetUp, "magnet, north pole up"});
  if (has(false)) items.push_back({LegendMark::dot, theme::kMagnetDown, "magnet, south pole up"});
  return items;
}

}  // namespace sf::viz
