#include "sensors/tilted_scans.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/elementary.h"
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

void TiltedScans::cast(const PlanarBeams& beams, std::uint32_t mover, std::span<const base::RigidTransform> X_WS,
                       double range_max, unsigned thread, TiltedScan& out) {
  Scratch& scratch = scratch_[thread];
  const base::RigidTransform& last = X_WS.back();
  double reach = range_max;
  for (const base::RigidTransform& X : X_WS) reach = std::max(reach, range_max + glm::distance(X.p, last.p));
  const bool floor = scene_.list(mover, last.p, reach, scratch.instances);
  const scene::SceneView view{scratch.instances, floor, scene_.terrain()};
  const std::size_t count = beams.directions.size();
  out.ranges.resize(count), out.hits.resize(count);
  out.quality.assign(count, base::QualityFlag::none);
  for (std::size_t t = 0; t < beams.pattern.size(); ++t) {
    const scene::BeamTile& tile = beams.pattern[t];
    const base::RigidTransform& X = X_WS[X_WS.size() == 1 ? 0 : t];
    if (!reference_) {
      scratch.rasterizer.scan(X, {&tile, 1}, range_max, view, {out.ranges, out.hits, out.quality});
      continue;
    }
    for (const std::uint32_t i : std::span(tile.place).first(tile.used * scene::kWidth)) {
      const auto hit = scene::reference_scan(X, beams.directions[i], range_max, view);
      out.ranges[i] = static_cast<double>(hit.range), out.hits[i] = hit.owner;
    }
  }
}

}  // namespace sf::sensors
