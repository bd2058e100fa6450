// The shipped run of MiniMAGIC.

#include <gtest/gtest.h>

#include "scenarios/experiment.h"
#include "scenarios/scenario.h"
#include "scenarios/trial.h"
#include "tests/device.h"

namespace sf::scenarios {
namespace {

// Without `check_sweep`, seeds 1 to 4 have 67 contacts.
TEST(MiniMagic, PioneersHaveNoContacts) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/minimagic.toml");
    scenario.seed = seed;
    const Trial trial = run_trial(scenario, disturbed_world(scenario, {}), device(), {});
    for (std::size_t i = 0; i < trial.counts.size(); ++i) {
      EXPECT_EQ(trial.counts[i].contacts, 0u) << trial.tracks[i].name << ", seed " << seed;
      if (trial.tracks[i].name.starts_with("pioneer")) EXPECT_GT(trial.counts[i].travelled, 20.0) << "it drives";
    }
  }
}

}  // namespace
}  // namespace sf::scenarios
