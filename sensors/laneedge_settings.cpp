#include "sensors/laneedge_settings.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "raycast/ray_caster.h"
#include "sensors/accuracy.h"
#include "sensors/lane_markings/filtered_scene.h"
#include "sensors/lane_markings/line_fit.h"
#include "sensors/laser_modes.h"
#include "sensors/laser_settings.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr double kDegrees = M_PI / 180.0;
constexpr double kLongestEdgeRange = 1e4;  // [m] limit of range_max

/// Returns the robot's axis nearest to the middle bearing of the beams. In a tie, the sides take precedence over front
/// and back.
double nearest_axis(double yaw) {
  const glm::dvec2 d = base::rotate(yaw, {1.0, 0.0});
  if (std::fabs(d.y) >= std::fabs(d.x) * (1.0 - 1e-9)) return d.y >= 0.0 ? 0.5 * M_PI : -0.5 * M_PI;
  return d.x >= 0.0 ? 0.0 : M_PI;
}

constexpr double kStraightError = 1e-8;  // [m] error of a distance near the origin

/// Casts one of this many beams, per mode.
constexpr std::uint32_t kEveryRay[] = {1, 2, 4};
static_assert(std::size(kEveryRay) == std::size(kLaneEdgeModes));

/// Keeps the field of view with fewer beams, but at least three, because fewer do not determine a line.
void thin_out(LaneEdge& edge, std::uint32_t every) {
  if (edge.fan.samples > 3) edge.fan.samples = std::max(3u, (edge.fan.samples - 1 + every - 1) / every + 1);
}

}  // namespace

LaneEdge lane_edge_of(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number_of_type) {
  LaneEdge edge;
  edge.row = common_spec(sensor, mover, number_of_type);
  raycast::ScanSettings& fan = edge.fan;
  fan.samples = whole(sensor, "samples", 61, 1, kMostEdgeSamples);
  fan.fov = angle(sensor, "fov", 30.0 * kDegrees, 0.0, 2.0 * M_PI);
  fan.range_max = length(sensor, "range_max", 1.0, 1e-6, kLongestEdgeRange);
  fan.range_min = length(sensor, "range_min", 0.0, 0.0, fan.range_max);
  edge.single = fan.samples <= 2;
  if (!edge.single && !(fan.fov > 0.0))
    refuse(sensor, "fov",
           "a line requires rays with different bearings; expected a 'fov' above 0, or 'samples 1' for one ray");
  fan.name = sensor.name;
  fan.X_MS = sensor.X_MS;
  fan.X_MS.z += 0.5 * sensor.height;
  fan.noise = scan_noise_of(sensor);
  const double bearing = angle(sensor, "perpendicular", nearest_axis(fan.X_MS.yaw), -4.0 * M_PI, 4.0 * M_PI);
  edge.perpendicular = base::rotate(bearing - fan.X_MS.yaw, {1.0, 0.0});
  edge.distance_max = kFarthest * fan.range_max;
  edge.row.X_MS = fan.X_MS;
  edge.row.limit = edge.distance_max;
  edge.row.dependency_radius = edge.row.reach = fan.range_max;
  edge.row.sigma = fan.noise.has_range() || fan.noise.angle_sigma > 0.0 ? HUGE_VAL : 0.0;  // readings have their own
                                                                                           // sigma
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

bool uses_raster(const world::World& world) { return world.road_resolution > 0.0 && !world.lane_markings.empty(); }

/// A range's error is 2^-53 times the terms of its products over the sine of incidence, so its point's error across the
/// edge is 2^-53 times these terms. The edge's corners are rounded at their coordinates, and a point's x has 44 bits
/// (SF_GRAIN_MASK).
double point_error(const LaneEdge& edge, double longest, double farthest) {
  return 0x1p-44 * edge.fan.range_max + 0x1p-53 * 16.0 * (edge.fan.range_max + longest + farthest);
}

double lane_edge_bound(const LaneEdge& edge, double longest, double farthest) {
  return kStraightError + point_error(edge, longest, farthest) / raycast::kMinSine;
}

base::QualityFlag quality_of(const EdgeReading& reading, double error, double bound) {
  if (std::isnan(reading.distance)) return base::QualityFlag::none;  // no distance
  const double gain = std::max(reading.gain, 1.0);
  if (reading.distance < bound) error += SF_CONTACT_DISTANCE;            // a shorter beam may read 0
  error = 2.0 * (error + std::sqrt(reading.points) * reading.residual);  // bound of a point's distance from the line
  const bool straight = reading.points > 2.5 && reading.others == 0.0 && error <= bound;
  if (!straight) return base::QualityFlag::not_straight;
  if (gain >= SF_NO_GAIN) return base::QualityFlag::extrapolated;
  return gain * error <= bound ? base::QualityFlag::none : base::QualityFlag::grazing;
}

ErrorBound bound_of_lane_edge(const world::World& world, const ParsedSensors& sensors, std::size_t at) {
  const SensorSpec& row = sensors.rows[at];
  if (uses_raster(world)) return {HUGE_VAL, "markings in pixels: each reading carries its sigma"};
  if (row.sigma > 0.0) return {HUGE_VAL, "noise affects the line: each reading carries its sigma"};
  if (row.mode > 0) return {HUGE_VAL, "skipped rays may have met another edge: each reading carries its sigma"};
  const double longest = reaches_of(filter_scene(world, true).world).longest;
  const LaneEdge& edge = sensors.settings_as<LaneEdge>()[at];
  return {lane_edge_bound(edge, longest, reaches_of(world).farthest + edge.fan.range_max),
          "one straight edge, visible on both sides; other readings are flagged"};
}

}  // namespace sf::sensors
