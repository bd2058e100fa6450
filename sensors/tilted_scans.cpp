#include "sensors/tilted_scans.h"

#include "base/elementary.h"
#include "scene/reference_scan.h"

namespace sf::sensors {

PlanarBeams planar_beams(std::span<const double> bearings) {
  PlanarBeams beams;
  for (const double bearing : bearings) {
    const auto [s, c] = base::sin_cos(bearing);
    beams.directions.push_back({c, s, 0.0});
  }
  beams.pattern = scene::make_pattern(beams.directions, static_cast<std::uint32_t>(bearings.size()));
  return beams;
}

TiltedScans::TiltedScans(const world::World& world, double reach, bool reference, unsigned threads)
    : scene_(world, reach), reference_(reference), scratch_(threads) {}

void TiltedScans::cast(const PlanarBeams& beams, std::uint32_t mover, const base::Pose& X_MS, double range_max,
                       unsigned thread, TiltedScan& out) {
  Scratch& scratch = scratch_[thread];
  const base::RigidTransform X_WS = base::compose(scene_.X_WM(mover), base::transform_of(X_MS));
  const bool floor = scene_.list(mover, X_WS.p, range_max, scratch.instances);
  const scene::SceneView view{scratch.instances, floor};
  const std::size_t count = beams.directions.size();
  out.ranges.resize(count), out.hits.resize(count);
  out.quality.assign(count, base::QualityFlag::none);
  if (!reference_) {
    scratch.rasterizer.scan(X_WS, beams.pattern, range_max, view, {out.ranges, out.hits, out.quality});
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto hit = scene::reference_scan(X_WS, beams.directions[i], range_max, view);
    out.ranges[i] = static_cast<double>(hit.range), out.hits[i] = hit.owner;
  }
}

}  // namespace sf::sensors
