#include "sensors/tilted_scans.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/elementary.h"
#include "base/time.h"
#include "scene/reference_scan.h"

namespace sf::sensors {

PlanarBeams planar_beams(std::span<const double> bearings, std::span<const double> times) {
  PlanarBeams beams;
  for (const double bearing : bearings) {
    const auto [s, c] = base::sin_cos(bearing);
    beams.directions.push_back({c, s, 0.0});
  }
  beams.pattern = scene::make_pattern(beams.directions, static_cast<std::uint32_t>(bearings.size()), times);
  return beams;
}

TiltedScans::TiltedScans(const world::World& world, double reach, bool reference, unsigned threads)
    : scene_(world, reach), reference_(reference), scratch_(threads) {}

void TiltedScans::cast(const PlanarBeams& beams, std::uint32_t mover, const base::RigidTransform& X_MS,
                       double range_max, const MoverTrails* trails, unsigned thread, TiltedScan& out) {
  auto& [rasterizer, list] = scratch_[thread];
  base::RigidTransform X = base::compose(scene_.X_WM(mover), X_MS);
  SensorView surroundings{.mover = mover, .p = X.p, .range = range_max, .trails = trails};
  if (trails != nullptr) {
    surroundings.since = trails->now() + base::nanoseconds(beams.pattern.front().time);
    for (const scene::BeamTile& tile : beams.pattern)
      surroundings.since = std::min(surroundings.since, trails->now() + base::nanoseconds(tile.time));
    surroundings.range += trails->reach(mover) + 2.0 * glm::length(X_MS.p);
  }
  scene_.list(surroundings, list);
  const scene::SceneView view{list.instances, list.floor, scene_.terrain()};
  const std::size_t count = beams.directions.size();
  out.ranges.resize(count), out.hits.resize(count);
  out.quality.assign(count, base::QualityFlag::none);
  for (const scene::BeamTile& tile : beams.pattern) {
    if (trails != nullptr) {
      const std::int64_t time = trails->now() + base::nanoseconds(tile.time);
      move_to(time, *trails, list, list.instances);
      X = base::compose(trails->X_WM(mover, time), X_MS);
    }
    if (!reference_) {
      rasterizer.scan(X, {&tile, 1}, range_max, view, {out.ranges, out.hits, out.quality});
      continue;
    }
    for (const std::uint32_t i : std::span(tile.place).first(tile.used * scene::kWidth)) {
      const auto hit = scene::reference_scan(X, beams.directions[i], range_max, view);
      out.ranges[i] = static_cast<double>(hit.range), out.hits[i] = hit.owner;
    }
  }
}

}  // namespace sf::sensors
