#include "viz/world_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <vector>

#include "sensors/laser.h"
#include "sensors/laser_modes.h"
#include "viz/axes.h"
#include "viz/color.h"
#include "viz/labels.h"
#include "viz/mover_layer.h"
#include "viz/road_layer.h"
#include "viz/sensor_overlay.h"
#include "viz/signal_layer.h"
#include "viz/theme.h"
#include "viz/visibility_layer.h"
#include "viz/wall_layer.h"

namespace sf::viz {
namespace {

using base::Pose;
using sensors::CastLaser;
using sensors::LaserSettings;
using sensors::ParsedSensors;
using world::Mover;
using world::World;

constexpr std::size_t kNamedMovers = 20;
constexpr std::size_t kOutlinedViews = 300;

bool crowded(const World& world) { return world.movers.size() > kNamedMovers; }

/// [px] Returns the outline of a laser's visible area, counter-clockwise in the world; a full turn has no corner at the
/// sensor.
std::vector<glm::dvec2> view_outline(const Axes& axes, const World& world, const Pose& X_WS,
                                     const LaserSettings& laser) {
  std::vector<glm::dvec2> points;
  const bool whole_turn = laser.fov > 2.0 * M_PI - 1e-3;
  if (!whole_turn) points.push_back(axes.pixel({X_WS.x, X_WS.y}));
  const double arc = laser.fov * laser.range_max * axes.scale();
  const int beams = std::clamp(static_cast<int>(arc), 16, crowded(world) ? 240 : 2000);
  for (const glm::dvec2& end : visible_points(world, X_WS, laser, beams)) points.push_back(axes.pixel(end));
  return points;
}

/// Draws a few fields of view one by one, so that overlaps are visible. Draws many as one translucent union, with thin
/// outlines up to a limit.
void draw_views(Axes& axes, const World& world, const ParsedSensors& lasers) {
  const bool many = crowded(world);
  std::map<std::uint32_t, std::vector<Line>> unions;
  for (std::size_t k = 0; k < lasers.rows.size(); ++k) {
    const LaserSettings& laser = lasers.settings_as<CastLaser>()[k].laser;
    const Pose X_WS = compose(world.movers[lasers.rows[k].mover].X_WM, laser.X_MS);
    std::vector<glm::dvec2> outline = view_outline(axes, world, X_WS, laser);
    const std::uint32_t edge = mix(laser.color, theme::kFrame, 0.3);
    if (!many) axes.canvas().polygon(outline, with_opacity(laser.color, 0.13));
    outline.push_back(outline.front());
    if (!many) axes.canvas().polyline(outline, theme::kHairline, with_opacity(edge, 0.55));
    auto& edges = unions[laser.color | theme::kBlack];
    for (std::size_t i = 0; many && i + 1 < outline.size(); ++i) edges.push_back({outline[i], outline[i + 1]});
  }
  for (const auto& [color, edges] : unions) {
    if (!many) continue;
    axes.canvas().area(edges, with_opacity(color, 0.12));
    if (world.movers.size() <= kOutlinedViews)
      axes.canvas().lines(edges, 0.5, with_opacity(mix(color, theme::kFrame, 0.3), 0.22));
  }
}

/// Draws a dashed circle around a mover that follows TAG packets.
void draw_tag(Axes& axes, const Mover& mover) {
  const glm::dvec2 middle = axes.pixel({mover.X_WM.x, mover.X_WM.y});
  const double radius = std::max(mover.radius * axes.scale(), kSmallestMark) + 4.0;
  std::vector<Line> circle;
  for (int i = 0; i < 64; ++i)
    circle.push_back({middle + base::rotate(i * M_PI / 32, {radius, 0.0}),
                      middle + base::rotate((i + 1) * M_PI / 32, {radius, 0.0})});
  draw_dashes(axes.canvas(), circle, 2.0, 6.0, 3.0, theme::kTag);
}

/// Draws names next to their robots, never over each other, robots or lights; omits names without room.
void draw_names(Axes& axes, const World& world) {
  TextStyle style = small_text();
  style.halo = theme::kWhite;
  Labels labels(axes.layout().plot);
  const auto keep_free = [&](glm::dvec2 at, double reach) {
    labels.forbid({at - glm::dvec2{reach, reach}, at + glm::dvec2{reach, reach}});
  };
  const auto reach_of = [&](const Mover& mover) { return std::max(mover.radius * axes.scale(), kSmallestMark); };
  for (const world::Segment& wall : world.walls) {
    const glm::dvec2 line[] = {axes.pixel(wall.a), axes.pixel(wall.b)};
    labels.avoid(line, 2.0);
  }
  for (const world::Light& light : world.lights) keep_free(axes.pixel({light.X_WL.x, light.X_WL.y}), 9.0);
  for (const Mover& mover : world.movers) keep_free(axes.pixel({mover.X_WM.x, mover.X_WM.y}), 0.8 * reach_of(mover));
  for (const Mover& mover : world.movers) {
    const glm::dvec2 mark[] = {axes.pixel({mover.X_WM.x, mover.X_WM.y})};
    const double near = reach_of(mover) + 4.0;
    labels.place(axes.canvas(), mark, mover.name, style,
                 {.nearest = near, .farthest = near + 70.0, .leader = near + 12.0, .clear_cost = 0.4});
  }
}

/// "laser 270 deg, 8 m": the common value of all lasers with one colour, or their range of values.
std::vector<LegendItem> view_legend(const World& world, const ParsedSensors& lasers, const world::Extent& shown) {
  struct Seen {
    std::set<double> fovs, ranges;
  };
  std::map<std::uint32_t, Seen> by_color;
  for (std::size_t k = 0; k < lasers.rows.size(); ++k) {
    const LaserSettings& laser = lasers.settings_as<CastLaser>()[k].laser;
    const Pose& X_WM = world.movers[lasers.rows[k].mover].X_WM;
    const glm::dvec2 at{X_WM.x, X_WM.y};
    if (!is_in_view({&at, 1}, shown, laser.range_max)) continue;
    Seen& seen = by_color[laser.color | theme::kBlack];
    seen.fovs.insert(std::round(laser.fov * 1800.0 / M_PI) / 10.0);
    seen.ranges.insert(laser.range_max);
  }
  const auto span = [](const std::set<double>& values) {
    return values.size() == 1 ? fmt::format("{:g}", *values.begin())
                              : fmt::format("{:g} to {:g}", *values.begin(), *values.rbegin());
  };
  std::vector<LegendItem> items;
  for (const auto& [color, seen] : by_color)
    items.push_back({LegendMark::block, with_opacity(color, 0.13),
                     fmt::format("laser, {} deg, {} m", span(seen.fovs), span(seen.ranges)),
                     with_opacity(mix(color, theme::kFrame, 0.3), 0.55)});
  return items;
}

/// @param world the part that the figure shows  @param lasers of the whole world
std::vector<LegendItem> legend_of(const World& world, const World& whole, const ParsedSensors& lasers,
                                  const world::Extent& shown) {
  std::vector<LegendItem> items = wall_legend(world, WallColors::of_models);
  const auto ground = road_legend(world);
  items.insert(items.end(), ground.begin(), ground.end());
  const auto signals = signal_layer_legend(world);
  items.insert(items.end(), signals.begin(), signals.end());
  const auto first = [&](bool tag) {
    return std::find_if(world.movers.begin(), world.movers.end(), [&](const Mover& m) { return m.is_tag == tag; });
  };
  if (const auto robot = first(false); robot != world.movers.end())
    items.push_back({LegendMark::robot, body_color(world, *robot), "robot and heading"});
  if (first(true) != world.movers.end()) items.push_back({LegendMark::dashed, theme::kTag, "follows a tag"});
  const auto views = view_legend(whole, lasers, shown);
  items.insert(items.end(), views.begin(), views.end());
  const auto carried = crowded(whole) ? std::vector<LegendItem>() : sensor_legend(world);
  items.insert(items.end(), carried.begin(), carried.end());
  return items;
}

std::string count(std::size_t n, const char* one) { return fmt::format("{} {}{}", n, one, n == 1 ? "" : "s"); }

std::string subtitle_of(const World& world, std::size_t lasers) {
  const auto tags = static_cast<std::size_t>(
      std::count_if(world.movers.begin(), world.movers.end(), [](const Mover& m) { return m.is_tag; }));
  std::string text = count(world.movers.size() - tags, "robot") + ", ";
  if (lasers > 0) text += count(lasers, "laser") + ", ";
  if (tags > 0) text += count(tags, "tag") + ", ";
  text += count(world.walls.size(), "wall segment");
  if (!world.lane_markings.empty()) text += ", " + count(world.lane_markings.size(), "stripe");
  if (!world.magnets.empty()) text += ", " + count(world.magnets.size(), "magnet");
  if (!world.lights.empty()) text += ", " + count(world.lights.size(), "light");
  return text + fmt::format(", {:.4g} m x {:.4g} m", world.extent.x_max - world.extent.x_min,
                            world.extent.y_max - world.extent.y_min);
}

}  // namespace

void draw_world(const World& world, const std::string& path, const Page& page) {
  const ParsedSensors lasers = sensors::laser_type.parse(world);
  FigureOptions options;
  options.title = world.name.empty() ? std::filesystem::path(world.file).filename().string() : world.name;
  options.subtitle = subtitle_of(world, lasers.rows.size());
  options.extent = world.extent;
  options.page = page;
  options.legend = legend_of(in_view(world, options), world, lasers, lay_out(options).shown);
  Axes axes(std::move(options));
  draw_lane_markings(axes, world);
  draw_floor_holes(axes, world);
  draw_magnets(axes, world);
  draw_emitters(axes, world);
  draw_views(axes, world, lasers);
  draw_walls(axes, world, WallColors::of_models);
  draw_lights(axes, world);
  for (const Mover& mover : world.movers) draw_body(axes, mover, mover.X_WM, body_color(world, mover));
  if (!crowded(world)) draw_sensors(axes, world);
  for (const Mover& mover : world.movers)
    if (mover.is_tag) draw_tag(axes, mover);
  if (!crowded(world)) draw_names(axes, world);
  axes.save(path);
}

}  // namespace sf::viz
