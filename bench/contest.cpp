#include "bench/contest.h"

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

void rate(Entrant& entrant, const Entrant& reference) {
  const Cost times = ratio(reference.turns, entrant.turns);
  entrant.ratio = times.wall_s;
  entrant.cpu_ratio = times.cpu_s;
}

}  // namespace

Outcome compete(const Scans& scans, const std::vector<std::unique_ptr<Caster>>& casters, const std::string& reference,
                std::size_t turns) {
  Outcome outcome{scans.scene, scans.robots(), scans.rays(), scans.laser.range_max, {}};
  for (const auto& caster : casters) {
    Entrant entrant;
    entrant.method = caster->name();
    for (std::size_t round = scans.rounds.size(); round-- > 0;) cast_once(*caster, round);
    entrant.verdict = judge(*caster, scans, 0, kJudgedRobots);
    entrant.hash = caster->hash();
    outcome.entrants.push_back(std::move(entrant));
  }
  for (std::size_t turn = 0; turn < turns; ++turn)
    for (std::size_t k = 0; k < casters.size(); ++k) {
      const std::size_t who = (turn + k) % casters.size();
      outcome.entrants[who].turns.push_back(cast_once(*casters[who], turn % scans.rounds.size()));
    }
  for (Entrant& entrant : outcome.entrants) entrant.typical = median(entrant.turns);
  const auto known = std::find_if(outcome.entrants.begin(), outcome.entrants.end(),
                                  [&](const Entrant& e) { return e.method == reference; });
  if (known != outcome.entrants.end())
    for (Entrant& entrant : outcome.entrants) rate(entrant, *known);
  return outcome;
}

}  // namespace sf::bench
