#include "raycast/cast_plan.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace sf::raycast {

namespace {

/// Scanners with equal keys share a beam table.
using BeamTableKey = std::tuple<double, std::uint32_t, std::uint32_t>;

}  // namespace

CastPlan::CastPlan(const world::World& world, std::vector<Scanner> planned, bool noise)
    : scanners(std::move(planned)), configs(world) {
  add_rows(world, noise);
  place_beams();
}

void CastPlan::add_rows(const world::World& world, bool noise) {
  std::vector<std::size_t> beams(world.movers.size(), 0);
  for (const Scanner& scanner : scanners) beams[scanner.mover] += scanner.scan.samples / scanner.scan.resolution;
  for (const Scanner& scanner : scanners) {
    ScannerRow row;
    row.plan = plan_beams(scanner.scan, noise);
    row.mover = scanner.mover;
    row.range_min = scanner.scan.range_min;
    row.single = scanner.single;
    row.mount = scanner.scan.X_MS;
    const double turn = noise ? kMaxSigmas * scanner.scan.noise.angle_sigma : 0.0;
    const ListConfig config{world.movers[scanner.mover].X_WM.z + row.mount.z, scanner.scan.range_max, row.plan.spread,
                            scanner.scan.fov + 2.0 * turn,
                            static_cast<std::uint32_t>(std::min<std::size_t>(beams[scanner.mover], 1'000'000))};
    row.config = configs.add(config);
    row.angle_noise = noise && scanner.scan.noise.angle_sigma > 0.0;
    any_angle_noise = any_angle_noise || row.angle_noise;
    row.out = result_lanes;
    result_lanes += row.plan.lanes();
    spare_lanes = std::max(spare_lanes, row.plan.lanes());
    rows.push_back(std::move(row));
  }
}

void CastPlan::place_beams() {
  struct Shared {
    std::uint32_t beams, pattern;
  };
  std::map<BeamTableKey, Shared> shared;
  for (std::size_t i = 0; i < scanners.size(); ++i) {
    ScannerRow& row = rows[i];
    const BeamTableKey key{scanners[i].scan.fov, scanners[i].scan.samples, scanners[i].scan.resolution};
    const auto known = shared.find(key);
    if (!row.angle_noise && known != shared.end()) {
      row.beams = known->second.beams;
      row.pattern = known->second.pattern;
      continue;
    }
    row.beams = beam_lanes;
    if (!row.angle_noise) {
      row.pattern = patterns++;
      shared[key] = {beam_lanes, row.pattern};
    }
    beam_lanes += row.plan.lanes();
  }
}

}  // namespace sf::raycast
