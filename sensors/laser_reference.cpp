#include "sensors/laser_reference.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "sensors/laser.h"
#include "sensors/laser_noise.h"

namespace sf::sensors {

LaserReference::LaserReference(const world::World& world, std::uint64_t seed, bool noise)
    : world_(world), seed_(seed), noise_(noise) {
  for (const world::Mover& mover : world.movers) poses_.push_back(mover.X_WM);
  lasers_.resize(world.movers.size());
  const ParsedSensors parsed = laser_type.parse(world);
  for (std::size_t i = 0; i < parsed.rows.size(); ++i)
    lasers_[parsed.rows[i].mover].push_back(parsed.settings_as<CastLaser>()[i]);
}

void LaserReference::set_poses(std::span<const Pose> poses) { poses_.assign(poses.begin(), poses.end()); }

std::vector<LaserReference::Seen> LaserReference::in_sight(std::uint32_t self, const Pose& X_WS, double range) const {
  std::vector<Seen> surfaces;
  const double reach = 1.001 * range + 1e-3;
  const auto add = [&](glm::dvec2 a, glm::dvec2 b, std::uint32_t id, std::uint32_t model) {
    const bool aside = std::max(a.x, b.x) < X_WS.x - reach || std::min(a.x, b.x) > X_WS.x + reach ||
                       std::max(a.y, b.y) < X_WS.y - reach || std::min(a.y, b.y) > X_WS.y + reach;
    if (!aside) surfaces.push_back({{{a.x, a.y, b.x, b.y}, id}, model});
  };
  std::uint32_t id = 0;
  for (const world::Segment& s : world_.walls) {
    if (s.seen_by_laser && s.z_min <= X_WS.z && X_WS.z < s.z_max) add(s.a, s.b, id, s.model);
    ++id;
  }
  for (std::uint32_t m = 0; m < world_.movers.size(); ++m) {
    const double height = X_WS.z - poses_[m].z;
    for (const world::Segment& s : world_.movers[m].body) {
      if (!s.seen_by_laser) continue;
      if (m != self && !base::is_absent(poses_[m]) && s.z_min <= height && height < s.z_max)
        add(base::transform(poses_[m], s.a), base::transform(poses_[m], s.b), id, s.model);
      ++id;
    }
  }
  return surfaces;
}

LaserReference::Scan LaserReference::scan(std::uint32_t mover, std::uint32_t number, std::uint64_t sequence,
                                          double slack) const {
  const CastLaser& cast = laser(mover, number);
  const LaserSettings& l = cast.laser;
  const raycast::BeamPlan plan = raycast::plan_beams(l, noise_);
  Scan scan{base::compose(poses_[mover], l.X_MS), std::vector<double>(l.samples), std::vector<std::uint32_t>(l.samples),
            std::vector<base::QualityFlag>(l.samples)};
  std::vector<double> turns(noise_ && l.noise.angle_sigma > 0.0 ? plan.samples.size() : 0);
  draw_angle_noise(l, plan, {seed_, base::RandomStream::angle_noise, mover, number, sequence}, turns);

  const std::vector<Seen> surfaces = in_sight(mover, scan.X_WS, l.range_max);
  const double least = cast_settings(l).range_min;
  const glm::dvec2 heading = base::direction(scan.X_WS.yaw);
  std::vector<double> ranges(SF_BEAMS_PER_LANE * std::size_t{plan.lanes()});
  std::vector<std::uint32_t> hits(ranges.size());
  for (std::size_t k = 0; k < plan.samples.size(); ++k) {
    const double bearing = bearing_of(l, plan.samples[k]) + (turns.empty() ? 0.0 : turns[k]);
    const glm::dvec2 beam = base::direction(bearing);
    const glm::dvec2 d{heading.x * beam.x - heading.y * beam.y, heading.y * beam.x + heading.x * beam.y};
    raycast::ClosestHit nearest{l.range_max};
    std::uint32_t model = SF_NO_HIT;
    for (const Seen& seen : surfaces) {
      const std::uint32_t before = nearest.id;
      intersect(seen.surface, {scan.X_WS.x, scan.X_WS.y}, d, nearest);
      if (nearest.id != before) model = seen.model;
    }
    const bool at_least = std::abs(nearest.range - l.range_min) < std::abs(slack);
    ranges[plan.place(k)] = at_least ? (slack > 0.0 ? l.range_min : least) : std::max(nearest.range, least);
    hits[plan.place(k)] = nearest.range < l.range_max ? model : SF_NO_HIT;
  }
  finish_scan(cast, plan, {seed_, base::RandomStream::range_noise, mover, number, sequence}, noise_,
              {ranges.data(), hits.data()}, {scan.ranges, scan.hits, scan.quality});
  return scan;
}

}  // namespace sf::sensors
