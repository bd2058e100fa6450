#include "viz/carried.h"

#include <cmath>

#include "sensors/laneedge_settings.h"
#include "sensors/magnetometer.h"
#include "viz/color.h"

namespace sf::viz {

namespace {

constexpr std::uint32_t kFan = 0xFFEF6C00u;
constexpr std::uint32_t kElement = 0xFF6A1B9Au;
constexpr int kFanSides = 24;

void draw_fan(Axes& axes, const base::Pose& X_WS, const world::Laser& fan) {
  std::vector<Vec2> outline{axes.pixel({X_WS.x, X_WS.y})};
  for (int i = 0; i <= kFanSides; ++i) {
    const double bearing = fan.fov * (static_cast<double>(i) / kFanSides - 0.5);
    outline.push_back(axes.pixel(transform(X_WS, base::rotate(bearing, {fan.range_max, 0.0}))));
  }
  axes.canvas().polygon(outline, with_opacity(kFan, 0.16));
  outline.push_back(outline.front());
  axes.canvas().polyline(outline, 1.0, with_opacity(kFan, 0.7));
}

bool has(const world::World& world, std::string_view type) {
  for (const world::Mover& mover : world.movers)
    for (const world::Sensor& sensor : mover.sensors)
      if (sensor.type == type) return true;
  return false;
}

}  // namespace

void draw_carried(Axes& axes, const world::World& world) {
  for (const sensors::LaneEdge& edge : sensors::lane_edges_of(world))
    draw_fan(axes, compose(world.movers[edge.row.mover].X_WM, edge.fan.X_MS), edge.fan);
  for (const world::Mover& mover : world.movers)
    for (const world::Sensor& sensor : mover.sensors) {
      if (sensor.type != sensors::magnetometer_kind.word.type) continue;
      for (const base::Pose& X_SE : sensors::read_magnetometer(sensor).X_SE) {
        const base::Pose X_WE = compose(compose(mover.X_WM, sensor.X_MS), X_SE);
        axes.canvas().disc(axes.pixel({X_WE.x, X_WE.y}), 2.4, kElement);
      }
    }
}

std::vector<LegendItem> carried_legend(const world::World& world) {
  std::vector<LegendItem> items;
  if (has(world, sensors::laneedge_kind.word.type))
    items.push_back({Sample::block, with_opacity(kFan, 0.16), "lane edge sensor", with_opacity(kFan, 0.7)});
  if (has(world, sensors::magnetometer_kind.word.type)) items.push_back({Sample::dot, kElement, "magnetometer"});
  return items;
}

}  // namespace sf::viz
