#include "bench/lane_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "bench/lane_methods.h"
#include "raycast/reference_caster.h"
#include "sensors/lane_markings/host_fit.h"
#include "tests/sensors/brute_force.h"

namespace sf::bench {

namespace {

constexpr std::size_t kJudged = 60;
constexpr std::size_t kPlain = 1;  ///< index of the method that ratios refer to

/// Result of one method.
struct LaneMethodResult : Timing {
  double worst = 0.0;      ///< [m] largest difference from the reference, over readings that both produce
  std::size_t alone = 0;   ///< number of readings that only one of the two produces
  std::uint64_t hash = 0;  ///< of all readings of round 0
};

Cost read_once(LaneReader& reader, std::size_t round, std::size_t sensors) {
  reader.poison();
  const Cost start = now();
  reader.read(round);
  const Cost cost = since(start);
  for (std::size_t i = 0; i < sensors; ++i)
    SF_CHECK(reader.reading(i).distance != kPoisonDistance, reader.name() + " left sensors unanswered");
  return cost;
}

/// Tests every ray against every face in long double, then fits on the host.
sensors::EdgeReading brute_force(const LaneScene& scene, const LaneKnowledge& known, std::size_t i) {
  const base::Pose X_WS = base::compose(scene.rounds[0][i], known.X_MS[i]);
  const auto near = oracle::within(known.faces, {X_WS.x, X_WS.y}, known.job.range_max);
  std::vector<double> ranges;
  std::vector<std::uint32_t> tags;
  for (const glm::dvec2& beam : known.job.beams) {
    const long double direction = static_cast<long double>(X_WS.yaw) +
                                  std::atan2(static_cast<long double>(beam.y), static_cast<long double>(beam.x));
    const raycast::WideHit hit =
        raycast::nearest_surface(std::span<const world::Segment>(near),
                                 raycast::wide_beam({X_WS.x, X_WS.y}, {}, direction), known.job.range_max);
    ranges.push_back(static_cast<double>(hit.range));
    tags.push_back(hit.model);
  }
  sensors::fit::Points points;
  sensors::fit::make_points(known.rows[i], {ranges.data(), tags.data(), known.job.directions.data(), nullptr}, points);
  return sensors::fit::read_edge(known.rows[i], points, known.job.grains);
}

void check_accuracy(const LaneReader& reader, const std::vector<sensors::EdgeReading>& right, std::size_t every,
                    LaneMethodResult& method_result) {
  for (std::size_t k = 0; k < right.size(); ++k) {
    const sensors::EdgeReading r = reader.reading(k * every);
    const bool none = std::isnan(r.distance);
    if (none != std::isnan(right[k].distance))
      ++method_result.alone;
    else if (!none)
      method_result.worst = std::max(method_result.worst, std::fabs(r.distance - right[k].distance));
  }
}

}  // namespace

Report compare_lanes(gpu::Device& device, const LaneScene& scene, std::size_t repeats) {
  const auto known = know(scene);
  gpu::Device host{std::string(gpu::kHostDevice)};  // must outlive its farm
  std::vector<std::unique_ptr<LaneReader>> readers;
  readers.push_back(make_farm_lanes(scene, device));
  readers.push_back(make_plain_lanes(scene, *known, false));
  readers.push_back(make_plain_lanes(scene, *known, true));
  readers.push_back(make_farm_lanes(scene, host));
  const std::size_t sensors = known->rows.size();
  const std::size_t rays = sensors * known->job.beams.size();
  std::size_t seen = 0;  // sensors that see an edge in round 0
  std::vector<LaneMethodResult> results;

  for (const auto& reader : readers)
    for (std::size_t round = scene.rounds.size(); round-- > 0;) read_once(*reader, round, sensors);
  const std::size_t every = known->raster ? 1 : std::max<std::size_t>(1, sensors / kJudged);
  std::vector<sensors::EdgeReading> right;
  for (std::size_t i = 0; i < sensors; i += every)
    right.push_back(known->raster ? readers[kPlain]->reading(i) : brute_force(scene, *known, i));
  for (const auto& reader : readers) {
    LaneMethodResult method_result;
    method_result.method = reader->name();
    check_accuracy(*reader, right, every, method_result);
    for (std::size_t i = 0; i < sensors; ++i) {
      const sensors::EdgeReading r = reader->reading(i);
      method_result.hash = base::hash_bytes(&r, sizeof r, method_result.hash);
      if (results.empty()) seen += std::isnan(r.distance) ? 0 : 1;
    }
    results.push_back(std::move(method_result));
  }
  take_turns(results, repeats, readers[kPlain]->name(), [&](std::size_t k, std::size_t turn) {
    return read_once(*readers[k], turn % scene.rounds.size(), sensors);
  });

  const double resolution = scene.world.road_resolution;
  Report report{"lanes", "",
                "paint,method,sensors,rays,seen,wall_ms_median,cpu_ms_median,ratio_to_plain,cpu_ratio_to_plain,"
                "max_difference_m,readings_alone,hash"};
  const std::string raster = fmt::format("raster of {:g} m", resolution);
  report.text = fmt::format("\n{} lane edge sensors, {} rays, {}: {} see an edge\n{}  max diff m  alone\n", sensors,
                            rays, resolution > 0.0 ? raster : "exact paint", seen, heading("Mrays/s"));
  const auto csv = [&](const LaneMethodResult& e) {
    return fmt::format("\"{}\",\"{}\",{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3g},{},{}\n",
                       resolution > 0.0 ? raster : "exact", e.method, sensors, rays, seen, 1e3 * e.typical.wall_s,
                       1e3 * e.typical.cpu_s, e.ratio, e.cpu_ratio, e.worst, e.alone, base::hash_hex(e.hash));
  };
  add_methods(report, results, csv, [&](const LaneMethodResult& e) {
    return row(e, static_cast<double>(rays)) + fmt::format(" {:>11.1e} {:>6}\n", e.worst, e.alone);
  });
  return report;
}

}  // namespace sf::bench
