#include "selftest/suite.h"

#include <chrono>
#include <exception>

#include "base/thread_pool.h"

namespace sf::selftest {

std::span<const Case> cases() {
  static const std::vector<Case> all = [] {
    std::vector<Case> cases;
    for (const auto group : {world_size_cases, beam_cases, segment_cases, scan_cases, fleet_cases, magnet_cases,
                             lane_edge_cases, lidar_cases, accuracy_mode_cases, device_cases}) {
      const std::span<const Case> more = group();
      cases.insert(cases.end(), more.begin(), more.end());
    }
    return cases;
  }();
  return all;
}

const Case& failing_case() {
  static constexpr Case kFailure{"", "failure", "", "fails on purpose",
                                 [](Fixture&, Checks& checks) { checks.holds(false, "fails on purpose"); }};
  return kFailure;
}

Outcome run(const Case& c, Fixture& fixture) {
  Checks checks(fixture.stop());
  const auto begun = std::chrono::steady_clock::now();
  std::string thrown;
  try {
    c.run(fixture, checks);
  } catch (const base::Interrupted&) {
    throw;
  } catch (const std::exception& error) {
    thrown = error.what();
  }
  if (!thrown.empty()) checks.holds(false, "it ended with: " + thrown);
  Outcome outcome = checks.outcome();
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return outcome;
}

}  // namespace sf::selftest
