#include "bench/comparison.h"

#include <algorithm>

#include "base/error.h"

namespace sf::bench {

namespace {

constexpr std::size_t kJudgedRobots = 20;

Cost cast_once(Caster& caster, std::size_t round) {
  caster.poison();
  const Cost start = now();
  caster.cast(round);
  const Cost cost = now() - start;
  SF_CHECK(caster.unwritten() == 0, caster.name() + " left " + std::to_string(caster.unwritten()) + " rays unanswered");
  return cost;
}

void rate(MethodResult& method_result, const MethodResult& reference) {
  const Cost times = ratio(reference.repeats, method_result.repeats);
  method_result.ratio = times.wall_s;
  method_result.cpu_ratio = times.cpu_s;
}

}  // namespace

Comparison compare(const Scans& scans, const std::vector<std::unique_ptr<Caster>>& casters,
                   const std::string& reference, std::size_t repeats) {
  Comparison comparison{scans.scene, scans.robots(), scans.rays(), scans.laser.range_max, {}};
  for (const auto& caster : casters) {
    MethodResult method_result;
    method_result.method = caster->name();
    for (std::size_t round = scans.rounds.size(); round-- > 0;) cast_once(*caster, round);
    method_result.accuracy = check_accuracy(*caster, scans, 0, kJudgedRobots);
    method_result.hash = caster->hash();
    comparison.method_results.push_back(std::move(method_result));
  }
  for (std::size_t repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t k = 0; k < casters.size(); ++k) {
      const std::size_t who = (repeat + k) % casters.size();
      comparison.method_results[who].repeats.push_back(cast_once(*casters[who], repeat % scans.rounds.size()));
    }
  for (MethodResult& method_result : comparison.method_results) method_result.typical = median(method_result.repeats);
  const auto known = std::find_if(comparison.method_results.begin(), comparison.method_results.end(),
                                  [&](const MethodResult& e) { return e.method == reference; });
  if (known != comparison.method_results.end())
    for (MethodResult& method_result : comparison.method_results) rate(method_result, *known);
  return comparison;
}

}  // namespace sf::bench
