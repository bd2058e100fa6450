#include "viz/wall_layer.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <tuple>

#include "sensors/laser.h"
#include "viz/color.h"
#include "viz/theme.h"
#include "world/ground.h"

namespace sf::viz {
namespace {

enum class Kind { solid, passable, unseen, overhead };

/// Returns the height [m] above all movers and their loads, as if all were on the floor; infinite without movers.
double headroom(const world::World& world) {
  double top = world.movers.empty() ? std::numeric_limits<double>::infinity() : 0.0;
  for (const world::Mover& mover : world.movers) {
    const double z = world::clearance_of(world, mover);
    for (const world::Segment& s : mover.body) top = std::max(top, z + s.z_max);
  }
  for (const sensors::SensorSpec& laser : sensors::laser_type.parse(world).rows)
    top = std::max(top, world::clearance_of(world, world.movers[laser.mover]) + laser.X_MS.z);
  return top;
}

/// @param headroom [m] above the terrain, or the floor
Kind kind_of(const world::Segment& s, double headroom, const world::Ground& terrain) {
  if (s.z_min - terrain.height(0.5 * (s.a + s.b), s.z_min) >= headroom) return Kind::overhead;
  if (!s.seen_by_laser) return Kind::unseen;
  return s.stops_robots ? Kind::solid : Kind::passable;
}

struct Paint {
  std::uint32_t fill;
  std::uint32_t edge;
};

Paint paint_of(const world::World& world, std::uint32_t model, Kind kind, WallColors colors) {
  std::uint32_t base = theme::kWall;
  if (colors == WallColors::quiet)
    base = theme::kQuietWall;
  else if (model < world.models.size() && !world.models[model].is_bitmap)
    base = world.models[model].color;
  if (kind == Kind::unseen) return {theme::kNone, theme::kUnseenWall};
  const std::uint32_t edge = mix(base, theme::kBlack, colors == WallColors::quiet ? 0.25 : 0.4);
  if (kind == Kind::overhead) return {with_opacity(base, 0.15), with_opacity(edge, 0.7)};
  return {with_opacity(base, kind == Kind::solid ? 0.75 : 0.3), edge};
}

/// The walls of one model and kind, in canvas coordinates.
struct WallGroup {
  std::vector<Line> all;
  std::vector<Line> closed;
};

void draw_group(Canvas& canvas, const WallGroup& group, Kind kind, const Paint& paint) {
  if (!group.closed.empty() && paint.fill >> 24) canvas.area(group.closed, paint.fill);
  if (kind == Kind::solid) canvas.lines(group.all, 1.4, paint.edge);
  if (kind == Kind::passable || kind == Kind::overhead) draw_dashes(canvas, group.all, 1.4, 8.0, 4.0, paint.edge);
  if (kind == Kind::unseen) draw_dashes(canvas, group.all, 1.4, 1.5, 4.0, paint.edge);
}

}  // namespace

void draw_walls(Axes& axes, const world::World& world, WallColors colors) {
  // Draw walls that are invisible to lasers beneath visible ones.
  std::map<std::tuple<bool, std::uint32_t, Kind>, WallGroup> groups;
  const double room = headroom(world);
  const world::Ground terrain({}, world.terrain);
  for (const world::Segment& s : world.walls) {
    const Kind kind = kind_of(s, room, terrain);
    WallGroup& group = groups[{kind != Kind::unseen, s.model, kind}];
    const Line line{axes.pixel(s.a), axes.pixel(s.b)};
    group.all.push_back(line);
    if (s.solid_left) group.closed.push_back(line);
  }
  for (const auto& [key, group] : groups) {
    const Kind kind = std::get<Kind>(key);
    draw_group(axes.canvas(), group, kind, paint_of(world, std::get<std::uint32_t>(key), kind, colors));
  }
}

std::vector<LegendItem> wall_legend(const world::World& world, WallColors colors) {
  std::array<const world::Segment*, 4> seen{};
  const double room = headroom(world);
  const world::Ground terrain({}, world.terrain);
  for (const world::Segment& s : world.walls) {
    auto& first = seen[static_cast<std::size_t>(kind_of(s, room, terrain))];
    if (first == nullptr) first = &s;
  }
  std::vector<LegendItem> items;
  const auto paint = [&](Kind kind) {
    return paint_of(world, seen[static_cast<std::size_t>(kind)]->model, kind, colors);
  };
  if (seen[0]) items.push_back({LegendMark::block, paint(Kind::solid).fill, "wall", paint(Kind::solid).edge});
  if (seen[1]) items.push_back({LegendMark::dashed, paint(Kind::passable).edge, "visible, does not stop robots"});
  if (seen[2]) items.push_back({LegendMark::dotted, paint(Kind::unseen).edge, "invisible to lasers"});
  if (seen[3]) items.push_back({LegendMark::dashed, paint(Kind::overhead).edge, "overhead"});
  return items;
}

}  // namespace sf::viz
