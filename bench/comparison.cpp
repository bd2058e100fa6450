#include "bench/comparison.h"

#include "base/error.h"

namespace sf::bench {

namespace {

constexpr std::size_t kJudgedRobots = 20;

Cost cast_once(Caster& caster, std::size_t round) {
  caster.poison();
  const Cost start = now();
  caster.cast(round);
  const Cost cost = since(start);
  SF_CHECK(caster.unwritten() == 0, caster.name() + " left " + std::to_string(caster.unwritten()) + " rays unanswered");
  return cost;
}

/// Returns the fastest method whose name begins with `peer`; empty if there is none.
std::string best_of(const std::vector<MethodResult>& results, const std::string& peer) {
  const MethodResult* best = nullptr;
  for (const MethodResult& result : results)
    if (result.method.starts_with(peer) && (best == nullptr || result.typical.cpu_s < best->typical.cpu_s))
      best = &result;
  return best != nullptr ? best->method : "";
}

}  // namespace

Comparison compare(const Scans& scans, const std::vector<std::unique_ptr<Caster>>& casters, const std::string& peer,
                   std::size_t repeats) {
  Comparison comparison{scans.scene, scans.robots(), scans.rays(), scans.laser.range_max, {}};
  for (const auto& caster : casters) {
    MethodResult method_result;
    method_result.method = caster->name();
    for (std::size_t round = scans.rounds.size(); round-- > 0;) cast_once(*caster, round);
    method_result.accuracy = check_accuracy(*caster, scans, 0, kJudgedRobots);
    method_result.hash = caster->hash();
    comparison.method_results.push_back(std::move(method_result));
  }
  take_turns(comparison.method_results, repeats, "",
             [&](std::size_t k, std::size_t turn) { return cast_once(*casters[k], turn % scans.rounds.size()); });
  set_ratios(comparison.method_results, best_of(comparison.method_results, peer));
  return comparison;
}

}  // namespace sf::bench
