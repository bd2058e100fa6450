#include "viz/sensor_overlay.h"

#include "sensors/laneedge_settings.h"
#include "sensors/magnetometer.h"
#include "viz/color.h"
#include "viz/theme.h"
#include "viz/view_sector.h"

namespace sf::viz {

namespace {

constexpr SectorStyle kSectorStyle{theme::kFieldOfView, 0.16, 0.7, 24};

bool has(const world::World& world, std::string_view type) {
  for (const world::Mover& mover : world.movers)
    for (const world::Sensor& sensor : mover.sensors)
      if (sensor.type == type) return true;
  return false;
}

}  // namespace

void draw_sensors(Axes& axes, const world::World& world) {
  for (const sensors::LaneEdge& edge : sensors::lane_edges_of(world))
    draw_view_sector(axes, compose(world.movers[edge.row.mover].X_WM, edge.fan.X_MS), -0.5 * edge.fan.fov,
                     0.5 * edge.fan.fov, edge.fan.range_max, kSectorStyle);
  for (const world::Mover& mover : world.movers)
    for (const world::Sensor& sensor : mover.sensors) {
      if (sensor.type != sensors::magnetometer_type.word.type) continue;
      for (const base::Pose& X_SE : sensors::read_magnetometer(sensor).X_SE) {
        const base::Pose X_WE = compose(compose(mover.X_WM, sensor.X_MS), X_SE);
        axes.canvas().disc(axes.pixel({X_WE.x, X_WE.y}), 2.4, theme::kMagnetometer);
      }
    }
}

std::vector<LegendItem> sensor_legend(const world::World& world) {
  std::vector<LegendItem> items;
  if (has(world, sensors::laneedge_type.word.type))
    items.push_back({LegendMark::block, with_opacity(kSectorStyle.color, kSectorStyle.inside), "lane edge sensor",
                     with_opacity(kSectorStyle.color, kSectorStyle.border)});
  if (has(world, sensors::magnetometer_type.word.type))
    items.push_back({LegendMark::dot, theme::kMagnetometer, "magnetometer"});
  return items;
}

}  // namespace sf::viz
