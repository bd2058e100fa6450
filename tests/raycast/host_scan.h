#pragma once
// Single host scans, and their reference: 64-bit intersection with all segments.

#include <vector>

#include "raycast/host_scene.h"
#include "robots/fleet.h"

namespace sf::raycast {

/// The results of a scan.
struct Scan {
  std::vector<double> ranges;
  std::vector<std::uint32_t> models;
  bool operator==(const Scan&) const = default;
};

inline ScanPattern pattern_of(const std::vector<double>& bearings) {
  std::vector<double> directions;
  for (const double b : bearings) directions.insert(directions.end(), {std::cos(b), std::sin(b)});
  ScanPattern pattern;
  pattern.assign(bearings, directions, bearings.front(), bearings.back());
  return pattern;
}

inline std::vector<double> even_bearings(std::size_t beams, double fov) {
  std::vector<double> bearings;
  for (std::size_t i = 0; i < beams; ++i)
    bearings.push_back(beams > 1 ? fov * (static_cast<double>(i) / static_cast<double>(beams - 1) - 0.5) : 0.0);
  return bearings;
}

inline Scan scan(const world::World& world, const Pose& X, std::uint32_t self, const ScanPattern& pattern,
                 double range) {
  base::ThreadPool thread_pool(1);
  ListConfigs configs(world);
  const Viewpoint view{configs.add({X.z, range, 0.0, 2.0 * M_PI}), self, X, {std::cos(X.yaw), std::sin(X.yaw)}};
  HostScene scene(world, configs, thread_pool);
  const std::vector<base::Report> states = robots::states_at_load(world);
  scene.place_movers(states);
  scene.prepare({&view, 1});
  Scan scan{std::vector<double>(pattern.beams), std::vector<std::uint32_t>(pattern.beams)};
  std::vector<std::uint8_t> grazes(pattern.beams);
  const ScanView from{.heading = view.heading, .yaw = X.yaw, .min_sine = 1e-3};
  scene.scan(0, from, pattern, 0, {scan.ranges.data(), scan.models.data(), grazes.data()});
  return scan;
}

/// Returns the reference scan: `intersect` with every wall and every edge of other movers.
inline Scan intersect_everything(const world::World& world, const Pose& X, std::uint32_t self,
                                 const ScanPattern& pattern, double range) {
  std::vector<ExactSegment> exact;
  std::vector<std::uint32_t> models;
  std::vector<CandidateSegment> surfaces;
  const auto add = [&](const ExactSegment& s, std::uint32_t model, bool met) {
    if (met) surfaces.push_back({s, static_cast<std::uint32_t>(models.size())});
    models.push_back(model);
  };
  for (const world::Segment& s : world.walls)
    add({s.a.x, s.a.y, s.b.x, s.b.y}, s.model, s.seen_by_laser && s.z_min <= X.z && X.z < s.z_max);
  base::ThreadPool thread_pool(1);
  MoverGeometry movers(world);
  std::vector<ExactSegment> moved(movers.segments());
  const std::vector<base::Report> states = robots::states_at_load(world);
  movers.place(states, thread_pool, moved);
  const auto rows = movers.first_rows();
  for (std::uint32_t row = 0; row < moved.size(); ++row)
    add(moved[row], movers.models()[row], row + rows[0] < rows[self] || row + rows[0] >= rows[self + 1]);
  Scan scan;
  const ScanView view{.origin = {X.x, X.y}, .heading = {std::cos(X.yaw), std::sin(X.yaw)}};
  for (std::size_t i = 0; i < pattern.beams; ++i) {
    ClosestHit best{range};
    for (const CandidateSegment& surface : surfaces)
      intersect(surface, view.origin, direction_of(view, pattern, i), best);
    scan.ranges.push_back(best.range);
    scan.models.push_back(best.id == SF_NO_HIT ? SF_NO_HIT : models[best.id]);
  }
  return scan;
}

}  // namespace sf::raycast
