#include "sensors/laneedge_settings.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sensors/accuracy.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kDegrees = M_PI / 180.0;
constexpr double kLongest = 1e4;  // [m] of range_max

world::LaserNoise noise_of(const world::Sensor& sensor) {
  const auto values = tuple(sensor, "noise", 3, "[constant proportional angular]");
  if (!values) return {};
  const auto& v = *values;
  if (!(v[0] >= 0.0 && v[1] >= 0.0 && v[2] >= 0.0))
    refuse(sensor, "noise", "'noise' expects numbers that are not negative");
  const world::LaserNoise noise{sensor.metres * v[0], v[1], sensor.radians * v[2]};
  if (!(noise.range_sigma <= kLongest && noise.range_proportional <= 1e3 && noise.angle_sigma <= 2.0 * M_PI))
    refuse(sensor, "noise", "'noise' is out of reach; expected [metres, metres per metre, angle]");
  return noise;
}

/// The robot's axis nearest to where the fan's middle looks; its sides before its front and back.
double nearest_axis(double yaw) {
  const base::Vec2 d = base::rotate(yaw, {1.0, 0.0});
  if (std::fabs(d.y) >= std::fabs(d.x) * (1.0 - 1e-9)) return d.y >= 0.0 ? 0.5 * M_PI : -0.5 * M_PI;
  return d.x >= 0.0 ? 0.0 : M_PI;
}

/// Of so many rays one is cast, in each mode.
constexpr std::uint32_t kEveryRay[] = {1, 2, 4};
static_assert(std::size(kEveryRay) == std::size(kLaneEdgeModes));

/// The same fan with fewer rays, three at least: with less there is no telling a line.
void thin_out(LaneEdge& edge, std::uint32_t every) {
  if (edge.fan.samples > 3) edge.fan.samples = std::max(3u, (edge.fan.samples - 1 + every - 1) / every + 1);
}

}  // namespace

LaneEdge lane_edge_of(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_kind) {
  LaneEdge edge;
  edge.row = common_row(sensor, mover, number_of_kind);
  world::Laser& fan = edge.fan;
  fan.samples = whole(sensor, "samples", 61, 1, kMostEdgeSamples);
  fan.fov = angle(sensor, "fov", 30.0 * kDegrees, 0.0, 2.0 * M_PI);
  fan.range_max = length(sensor, "range_max", 1.0, 1e-6, kLongest);
  fan.range_min = length(sensor, "range_min", 0.0, 0.0, fan.range_max);
  edge.single = fan.samples <= 2;
  if (!edge.single && !(fan.fov > 0.0))
    refuse(sensor, "fov", "a line needs rays that spread; expected a 'fov' above 0, or 'samples 1' for one ray");
  fan.name = sensor.name;
  fan.X_MS = sensor.X_MS;
  fan.X_MS.z += 0.5 * sensor.height;
  fan.rate = edge.row.rate;
  fan.noise = noise_of(sensor);
  const double bearing = angle(sensor, "perpendicular", nearest_axis(fan.X_MS.yaw), -4.0 * M_PI, 4.0 * M_PI);
  edge.perpendicular = base::rotate(bearing - fan.X_MS.yaw, {1.0, 0.0});
  edge.distance_max = kFarthest * fan.range_max;
  edge.row.X_MS = fan.X_MS;
  edge.row.limit = edge.distance_max;
  edge.row.reach = fan.range_max;
  edge.row.noisy = fan.noise.has_range() || fan.noise.angle_sigma > 0.0;
  return edge;
}

std::vector<LaneEdge> lane_edges_of(const world::World& world) {
  std::vector<LaneEdge> edges;
  for_each_of(world, "laneedge", [&](const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number) {
    LaneEdge edge = lane_edge_of(sensor, mover, number);
    edge.row.mode = mode_of("laneedge", kLaneEdgeModes, accuracy_of(sensor), world);
    thin_out(edge, kEveryRay[edge.row.mode]);
    edges.push_back(std::move(edge));
  });
  return edges;
}

Bound bound_of_lane_edge(const world::World& world, const SensorRow& sensor) {
  if (world.road_resolution > 0.0 && !world.stripes.empty())
    return {HUGE_VAL, "paint in pixels: each reading says its own sigma"};
  if (sensor.mode == 0) return {kStraightError, "straight edges; along curves each reading says its own sigma"};
  return {kStraightError, "one straight edge in sight; all readings are flagged: rays left out may have met another"};
}

}  // namespace sf::sensors
