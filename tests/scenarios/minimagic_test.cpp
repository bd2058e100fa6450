// The shipped run of MiniMAGIC.

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "scenarios/experiment.h"
#include "scenarios/scenario.h"
#include "scenarios/trial.h"
#include "tests/device.h"

namespace sf::scenarios {
namespace {

/// Results of two minutes, for each of the seeds 1 to 4.
std::vector<Trial> trials_of_minimagic() {
  std::vector<Trial> trials;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/minimagic.toml");
    scenario.seed = seed;
    trials.push_back(run_trial(scenario, disturbed_world(scenario, {}), device(), {}));
  }
  return trials;
}

// Without `check_sweep`, seeds 1 to 4 have 67 contacts.
TEST(MiniMagic, PioneersHaveNoContacts) {
  for (const Trial& trial : trials_of_minimagic())
    for (std::size_t i = 0; i < trial.counts.size(); ++i) {
      EXPECT_EQ(trial.counts[i].contacts, 0u) << trial.tracks[i].name;
      EXPECT_GT(trial.counts[i].travelled, trial.tracks[i].name.starts_with("pioneer") ? 20.0 : 1.0) << "it drives";
    }
}

TEST(MiniMagic, TargetsAndThreatsAreLocated) {
  const world::World world = world_of(read_scenario(SF_SOURCE_DIR "/experiments/minimagic.toml"));
  std::set<std::uint32_t> found;
  for (const Trial& trial : trials_of_minimagic())
    for (const Sighting& s : trial.sightings) {
      const auto mark = std::find_if(world.fiducials.begin(), world.fiducials.end(),
                                     [&](const world::Fiducial& f) { return f.id == s.id; });
      ASSERT_NE(mark, world.fiducials.end()) << s.id;
      EXPECT_EQ(s.type, static_cast<std::uint32_t>(mark->type));
      EXPECT_LT(glm::length(s.p - glm::dvec2{mark->X_BF.x, mark->X_BF.y}), 0.15) << "noise of 2 cm and 0.5 degrees";
      found.insert(s.id);
    }
  EXPECT_EQ(found.size(), world.fiducials.size()) << "also the threats in the barracks";
}

}  // namespace
}  // namespace sf::scenarios
