#include "bench/lane_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "bench/lane_methods.h"
#include "bench/report.h"
#include "tests/sensors/brute_force.h"
#include "tests/sensors/laneedge_mirror.h"

namespace sf::bench {

namespace {

constexpr std::size_t kJudged = 60;
constexpr std::size_t kPlain = 1;  ///< index of the method that ratios refer to

Cost read_once(LaneReader& reader, std::size_t round, std::size_t sensors) {
  reader.poison();
  const Cost start = now();
  reader.read(round);
  const Cost cost = now() - start;
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
    const oracle::Answer answer = oracle::cast(near, {X_WS.x, X_WS.y}, direction, known.job.range_max);
    ranges.push_back(answer.range);
    tags.push_back(answer.model);
  }
  mirror::Points points;
  mirror::make_points(known.rows[i], ranges, tags, known.job.directions, {}, points);
  return mirror::read_edge(known.rows[i], points, known.job.grains);
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

void rate(LaneMethodResult& method_result, const LaneMethodResult& plain) {
  const Cost times = ratio(plain.repeats, method_result.repeats);
  method_result.ratio = times.wall_s;
  method_result.cpu_ratio = times.cpu_s;
  method_result.typical = median(method_result.repeats);
}

}  // namespace

LaneComparison compare_lanes(gpu::Device& device, const LaneScene& scene, std::size_t repeats) {
  const auto known = know(scene);
  std::vector<std::unique_ptr<LaneReader>> readers;
  readers.push_back(make_farm_lanes(scene, device));
  readers.push_back(make_plain_lanes(scene, *known, false));
  readers.push_back(make_plain_lanes(scene, *known, true));
  const std::size_t sensors = known->rows.size();
  LaneComparison comparison{sensors, sensors * known->job.beams.size(), scene.world.road_resolution, 0, {}};

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
      if (comparison.method_results.empty()) comparison.seen += std::isnan(r.distance) ? 0 : 1;
    }
    comparison.method_results.push_back(std::move(method_result));
  }
  for (std::size_t repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t k = 0; k < readers.size(); ++k) {
      const std::size_t who = (repeat + k) % readers.size();
      comparison.method_results[who].repeats.push_back(read_once(*readers[who], repeat % scene.rounds.size(), sensors));
    }
  const LaneMethodResult plain = comparison.method_results[kPlain];
  for (LaneMethodResult& method_result : comparison.method_results) rate(method_result, plain);
  return comparison;
}

void write_lanes(const std::vector<LaneComparison>& comparisons, const std::string& folder) {
  if (comparisons.empty()) return;
  std::string text =
      "paint,method,sensors,rays,seen,wall_ms_median,cpu_ms_median,ratio_to_plain,cpu_ratio_to_plain,"
      "max_difference_m,readings_alone,hash\n";
  for (const LaneComparison& o : comparisons)
    for (const LaneMethodResult& e : o.method_results)
      text += fmt::format("\"{}\",\"{}\",{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3g},{},{}\n",
                          o.resolution > 0.0 ? fmt::format("raster of {:g} m", o.resolution) : "exact", e.method,
                          o.sensors, o.rays, o.seen, 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s, e.ratio,
                          e.cpu_ratio, e.worst, e.alone, base::hash_hex(e.hash));
  write(folder + "/lanes.csv", text);
}

std::string lane_table(const std::vector<LaneComparison>& comparisons) {
  std::string text;
  for (const LaneComparison& o : comparisons) {
    text += fmt::format("\n{} lane edge sensors, {} rays, {}: {} see an edge\n", o.sensors, o.rays,
                        o.resolution > 0.0 ? fmt::format("raster of {:g} m", o.resolution) : "exact paint", o.seen);
    for (const LaneMethodResult& e : o.method_results)
      text +=
          fmt::format("  {:26} {:8.2f} ms  {:8.2f} cpu ms  {:5.2f} x  {:5.2f} x cpu  {:.2g} m  {} alone\n", e.method,
                      1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s, e.ratio, e.cpu_ratio, e.worst, e.alone);
  }
  return text;
}

}  // namespace sf::bench
