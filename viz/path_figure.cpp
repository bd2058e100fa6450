#include "viz/path_figure.h"

#include <algorithm>
#include <cmath>

#include "viz/axes.h"
#include "viz/color.h"
#include "viz/road_layer.h"
#include "viz/theme.h"
#include "viz/wall_layer.h"
#include "world/path_geometry.h"

namespace sf::viz {
namespace {

constexpr double kStep = 0.02;  // [m] along the centre line

void draw_middle(Axes& axes, const world::Path& path) {
  const double length = world::length_of(path);
  const int steps = std::max(1, static_cast<int>(std::ceil(length / kStep)));
  std::vector<Line> lines;
  glm::dvec2 last{};
  for (int i = 0; i <= steps; ++i) {
    const base::Pose X_WP = world::pose_at(path, length * i / steps);
    const glm::dvec2 at = axes.pixel({X_WP.x, X_WP.y});
    if (i > 0) lines.push_back({last, at});
    last = at;
  }
  draw_dashes(axes.canvas(), lines, 1.4, 9.0, 7.0, theme::kReferencePath);
}

void draw_track(Axes& axes, const Track& track, std::uint32_t color, std::span<const double> dash) {
  std::vector<glm::dvec2> points;
  for (const base::Pose& pose : track.poses)
    if (is_finite(pose)) points.push_back(axes.pixel({pose.x, pose.y}));
  if (points.empty()) return;
  axes.canvas().polyline(points, 2.4, color, dash);
  axes.canvas().disc(points.front(), 5.0, theme::kWhite);
  axes.canvas().ring(points.front(), 4.2, 1.6, color);
  axes.canvas().disc(points.back(), 5.0, color);
}

}  // namespace

void draw_along_paths(const world::World& world, std::span<const Track> tracks, const std::string& title,
                      const std::string& subtitle, const std::string& file, const Page& page) {
  FigureOptions options{.title = title, .subtitle = subtitle, .extent = extent_of(world, tracks), .page = page};
  options.legend = road_legend(in_view(world, options));
  if (!world.paths.empty()) options.legend.push_back({LegendMark::dashed, theme::kReferencePath, "middle of the lane"});
  const auto color = [&](std::size_t i) { return tracks[i].color.value_or(row_color(i, tracks.size())); };
  const auto dash = [&](std::size_t i) { return page.line_styles ? line_style(i) : std::span<const double>(); };
  for (std::size_t i = 0; i < std::min<std::size_t>(tracks.size(), 7); ++i)
    if (std::any_of(tracks[i].poses.begin(), tracks[i].poses.end(), is_finite))
      options.legend.push_back({LegendMark::line, color(i), tracks[i].name, theme::kNone, dash(i)});
  Axes axes(std::move(options));
  draw_lane_markings(axes, world);
  draw_magnets(axes, world);
  draw_walls(axes, world, WallColors::quiet);
  for (const world::Path& path : world.paths) draw_middle(axes, path);
  for (std::size_t i = 0; i < tracks.size(); ++i) draw_track(axes, tracks[i], color(i), dash(i));
  axes.save(file);
}

}  // namespace sf::viz
