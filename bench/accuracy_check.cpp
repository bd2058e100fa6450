#include "bench/accuracy_check.h"

#include <algorithm>
#include <cmath>

#include "raycast/reference_caster.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"
#include "sensors/sensor_set.h"
#include "tests/sensors/brute_force.h"

namespace sf::bench {

namespace {

constexpr double kAtVertex = 1e-5;  ///< [m]

std::size_t stride(std::size_t all, std::size_t wanted) { return std::max<std::size_t>(1, all / wanted); }

/// [m] least distance of a beam from an end point of a surface up to `range`
double silhouette(std::span<const world::Segment> surfaces, const raycast::WideBeam& beam, double range) {
  double least = HUGE_VAL;
  for (const world::Segment& s : surfaces)
    for (const glm::dvec2& end : {s.a, s.b}) {
      const long double wx = static_cast<long double>(end.x) - beam.origin.x;
      const long double wy = static_cast<long double>(end.y) - beam.origin.y;
      const long double ahead = wx * beam.x + wy * beam.y;
      if (ahead > -1e-6L && ahead <= range + 1e-6L)
        least = std::min(least, static_cast<double>(std::fabs(wx * beam.y - wy * beam.x)));
    }
  return least;
}

template <class RangeOf>
void judge_robot(std::span<const world::Segment> surfaces, const base::Pose& X_WS, const sensors::LaserSettings& laser,
                 RangeOf range_of, AccuracyCheck& accuracy) {
  for (std::uint32_t i = 0; i < laser.samples; ++i) {
    const double direction = X_WS.yaw + bearing_of(laser, i);
    const raycast::WideBeam beam = raycast::wide_beam({X_WS.x, X_WS.y}, {}, direction);
    const auto range = static_cast<double>(raycast::nearest_surface(surfaces, beam, laser.range_max).range);
    ++accuracy.beams;
    if (silhouette(surfaces, beam, range) < kAtVertex)
      ++accuracy.at_vertex;
    else
      accuracy.max_error_m = std::max(accuracy.max_error_m, std::fabs(range - range_of(i)));
  }
}

}  // namespace

AccuracyCheck check_accuracy(const Caster& caster, const Scans& scans, std::size_t round, std::size_t robots) {
  const double z = scans.world.movers[0].X_WM.z + scans.laser.X_MS.z;
  const auto walls = oracle::surfaces(scans.world, scans.rounds[round], world::kNone, z);
  AccuracyCheck accuracy;
  for (std::size_t robot = 0; robot < scans.robots(); robot += stride(scans.robots(), robots))
    judge_robot(
        walls, scans.X_WS(round, robot), scans.laser, [&](std::size_t i) { return caster.range(robot, i); }, accuracy);
  return accuracy;
}

AccuracyCheck check_accuracy(std::span<const base::ReadingBlock> readings, const world::World& world,
                             std::span<const base::Pose> poses, std::size_t robots) {
  const sensors::SensorSet sensor_set(world);
  AccuracyCheck accuracy;
  for (std::size_t k = 0; k < readings.size(); k += stride(readings.size(), robots)) {
    const base::ReadingBlock& r = readings[k];
    const sensors::LaserSettings& laser =
        sensor_set.settings_of<sensors::CastLaser>(sensors::kLaser, r.mover)[r.sensor].laser;
    const auto seen = oracle::surfaces(world, poses, r.mover, r.X_WS.z);
    judge_robot(
        seen, r.X_WS, laser, [&](std::size_t i) { return r.values[i]; }, accuracy);
  }
  return accuracy;
}

}  // namespace sf::bench
