#include "viz/scan_map.h"

#include <algorithm>
#include <cmath>

#include "base/echo.h"
#include "base/elementary.h"
#include "base/tilted_pose.h"

namespace sf::viz {

namespace {

/// With these weights, a sum of exactly 0 (unexplored) can occur only after hundreds of scans.
constexpr maps::LogOddsUpdate kRule{.hit = 801, .miss = 100, .limit = 32767};

constexpr double kLongest = 4000.0;  // [cells] a map of 4096 x 4096 cells has the maximum number of words

}  // namespace

maps::GridGeometry grid_over(const world::Extent& extent) {
  const double width = extent.x_max - extent.x_min;
  const double height = extent.y_max - extent.y_min;
  const double longest = std::max(width, height);
  const double cell = std::max(std::clamp(std::ceil(longest / 8.0) / 100.0, 0.03, 1.0), longest / kLongest);
  const auto words = [&](double length) {
    return static_cast<std::uint32_t>(std::max(1.0, std::ceil(length / (4.0 * cell) - 1e-6)));
  };
  return {extent.x_min, extent.y_max, cell, words(width), words(height)};
}

ScanMap::ScanMap(const maps::GridGeometry& geometry) : odds_(geometry, kRule) {}

/// Replaces beams and ranges by their projections on the ground, in axes parallel to the world's. Beams that are too
/// short, or look straight up or down, leave no mark.
base::Pose ScanMap::project(const sensors::SensorSpec& laser, const base::RigidTransform& X_WS,
                            std::span<const glm::dvec2> beams) {
  projected_.assign(beams.begin(), beams.end());
  for (std::size_t k = 0; k < ranges_.size(); ++k) {
    const glm::dvec2 d{X_WS.R * glm::dvec3(beams[k], 0.0)};
    const double length = base::hypot(d.x, d.y);
    const bool drawn = length > 1e-6 && (laser.range_min == 0.0 || ranges_[k] > laser.range_min);
    ranges_[k] = drawn ? length * ranges_[k] : NAN;
    if (drawn) projected_[k] = d / length;
  }
  return {X_WS.p.x, X_WS.p.y, X_WS.p.z, 0.0};
}

void ScanMap::add(const world::World& world, const sensors::SensorSpec& laser, const base::RigidTransform& X_MS,
                  const base::ReadingBlock& scan) {
  const double behind = 0.5 * odds_.geometry.cell;
  double range_min = laser.range_min > 0.0 ? laser.range_min + behind : 0.0;
  const double range_max = std::min(laser.limit, maps::kMaxRangeCells * odds_.geometry.cell);
  ranges_.assign(scan.values.begin(), scan.values.end());
  base::mark_too_near(scan.quality, ranges_);
  ends_.resize(ranges_.size());
  std::vector<glm::dvec2>& level = beams_[{laser.fov, laser.elements}];
  if (level.empty()) level = maps::beam_directions(laser.fov, laser.elements);
  const bool is_tilted = !base::is_level(scan.tilt) || X_MS.R[2].z != 1.0;
  const base::Pose X_WS =
      is_tilted ? project(laser, compose(base::transform_of(scan.X_WM, scan.tilt), X_MS), level) : scan.X_WS;
  if (is_tilted) range_min = 0.0;
  for (double& range : ranges_) range += behind;
  const std::vector<glm::dvec2>& beams = is_tilted ? projected_ : level;
  const auto traced = maps::trace_scan(odds_.geometry, {X_WS, ranges_, beams, range_min, range_max}, ends_);
  for (std::size_t k = 0; k < scan.hits.size(); ++k) {
    const bool stays = scan.hits[k] < world.models.size() && world.models[scan.hits[k]].mover == world::kNone;
    if (!stays) ends_[k] = maps::without_hit(ends_[k]);
  }
  maps::add_traced_scan(odds_, traced, ends_);
}

}  // namespace sf::viz
