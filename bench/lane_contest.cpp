#include "bench/lane_contest.h"

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
constexpr std::size_t kPlain = 1;  ///< the entrant that ratios refer to

Cost read_once(LaneReader& reader, std::size_t round, std::size_t sensors) {
  reader.poison();
  const Cost start = now();
  reader.read(round);
  const Cost cost = now() - start;
  for (std::size_t i = 0; i < sensors; ++i)
    SF_CHECK(reader.reading(i).distance != kPoisonDistance, reader.name() + " left sensors unanswered");
  return cost;
}

/// Every ray against every face in long double, then the fit on the host.
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

void judge(const LaneReader& reader, const std::vector<sensors::EdgeReading>& right, std::size_t every,
           LaneEntrant& entrant) {
  for (std::size_t k = 0; k < right.size(); ++k) {
    const sensors::EdgeReading r = reader.reading(k * every);
    const bool none = std::isnan(r.distance);
    if (none != std::isnan(right[k].distance))
      ++entrant.alone;
    else if (!none)
      entrant.worst = std::max(entrant.worst, std::fabs(r.distance - right[k].distance));
  }
}

void rate(LaneEntrant& entrant, const LaneEntrant& plain) {
  const Cost times = ratio(plain.turns, entrant.turns);
  entrant.ratio = times.wall_s;
  entrant.cpu_ratio = times.cpu_s;
  entrant.typical = median(entrant.turns);
}

}  // namespace

LaneOutcome compete_lanes(gpu::Device& device, const LaneScene& scene, std::size_t turns) {
  const auto known = know(scene);
  std::vector<std::unique_ptr<LaneReader>> readers;
  readers.push_back(make_farm_lanes(scene, device));
  readers.push_back(make_plain_lanes(scene, *known, false));
  readers.push_back(make_plain_lanes(scene, *known, true));
  const std::size_t sensors = known->rows.size();
  LaneOutcome outcome{sensors, sensors * known->job.beams.size(), scene.world.road_resolution, 0, {}};

  for (const auto& reader : readers)
    for (std::size_t round = scene.rounds.size(); round-- > 0;) read_once(*reader, round, sensors);
  const std::size_t every = known->raster ? 1 : std::max<std::size_t>(1, sensors / kJudged);
  std::vector<sensors::EdgeReading> right;
  for (std::size_t i = 0; i < sensors; i += every)
    right.push_back(known->raster ? readers[kPlain]->reading(i) : brute_force(scene, *known, i));
  for (const auto& reader : readers) {
    LaneEntrant entrant;
    entrant.method = reader->name();
    judge(*reader, right, every, entrant);
    for (std::size_t i = 0; i < sensors; ++i) {
      const sensors::EdgeReading r = reader->reading(i);
      entrant.hash = base::hash_bytes(&r, sizeof r, entrant.hash);
      if (outcome.entrants.empty()) outcome.seen += std::isnan(r.distance) ? 0 : 1;
    }
    outcome.entrants.push_back(std::move(entrant));
  }
  for (std::size_t turn = 0; turn < turns; ++turn)
    for (std::size_t k = 0; k < readers.size(); ++k) {
      const std::size_t who = (turn + k) % readers.size();
      outcome.entrants[who].turns.push_back(read_once(*readers[who], turn % scene.rounds.size(), sensors));
    }
  const LaneEntrant plain = outcome.entrants[kPlain];
  for (LaneEntrant& entrant : outcome.entrants) rate(entrant, plain);
  return outcome;
}

void write_lanes(const std::vector<LaneOutcome>& outcomes, const std::string& folder) {
  if (outcomes.empty()) return;
  std::string text =
      "paint,method,sensors,rays,seen,wall_ms_median,cpu_ms_median,ratio_to_plain,cpu_ratio_to_plain,"
      "max_difference_m,readings_alone,hash\n";
  for (const LaneOutcome& o : outcomes)
    for (const LaneEntrant& e : o.entrants)
      text += fmt::format("\"{}\",\"{}\",{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3g},{},{}\n",
                          o.resolution > 0.0 ? fmt::format("raster of {:g} m", o.resolution) : "exact", e.method,
                          o.sensors, o.rays, o.seen, 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s, e.ratio,
                          e.cpu_ratio, e.worst, e.alone, base::hash_hex(e.hash));
  write(folder + "/lanes.csv", text);
}

std::string lane_table(const std::vector<LaneOutcome>& outcomes) {
  std::string text;
  for (const LaneOutcome& o : outcomes) {
    text += fmt::format("\n{} lane edge sensors, {} rays, {}: {} see an edge\n", o.sensors, o.rays,
                        o.resolution > 0.0 ? fmt::format("raster of {:g} m", o.resolution) : "exact paint", o.seen);
    for (const LaneEntrant& e : o.entrants)
      text +=
          fmt::format("  {:26} {:8.2f} ms  {:8.2f} cpu ms  {:5.2f} x  {:5.2f} x cpu  {:.2g} m  {} alone\n", e.method,
                      1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s, e.ratio, e.cpu_ratio, e.worst, e.alone);
  }
  return text;
}

}  // namespace sf::bench
