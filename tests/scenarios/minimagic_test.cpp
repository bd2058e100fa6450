// The shipped run of MiniMAGIC.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "scenarios/experiment.h"
#include "scenarios/scenario.h"
#include "scenarios/trial.h"
#include "tests/device.h"
#include "tests/instrumented.h"

namespace sf::scenarios {
namespace {

/// The shipped run with each of the seeds 1 to 3; in instrumented builds, the first half minute of one.
const std::vector<Trial>& trials_of_minimagic() {
  static const std::vector<Trial> all = [] {
    std::vector<Trial> trials;
    for (std::uint64_t seed = 1; seed <= (instrumented() ? 1 : 3); ++seed) {
      Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/minimagic.toml");
      scenario.seed = seed;
      if (instrumented()) scenario.duration = 30.0;
      trials.push_back(run_trial(scenario, disturbed_world(scenario, {}), device(), {}));
    }
    return trials;
  }();
  return all;
}

TEST(MiniMagic, PioneersHaveNoContacts) {
  for (const Trial& trial : trials_of_minimagic())
    for (std::size_t i = 0; i < trial.counts.size(); ++i) {
      EXPECT_EQ(trial.counts[i].contacts, 0u) << trial.tracks[i].name;
      EXPECT_GT(trial.counts[i].travelled, 1.0) << "it drives";
    }
}

// With this seed, an obstacle stops for a Pioneer whose turns it blocks: both would wait for ever.
TEST(MiniMagic, PioneersLeaveObstaclesThatWaitForThem) {
  if (instrumented()) GTEST_SKIP() << "half a minute is not enough";
  Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/minimagic.toml");
  scenario.seed = 14;
  const Trial trial = run_trial(scenario, disturbed_world(scenario, {}), device(), {});
  for (std::size_t i = 0; i < trial.counts.size(); ++i) {
    EXPECT_EQ(trial.counts[i].contacts, 0u) << trial.tracks[i].name;
    EXPECT_GT(trial.counts[i].travelled, trial.tracks[i].name == "tag2" ? 7.0 : 15.0) << trial.tracks[i].name;
  }
}

// Unknown are the insides of solids, what is outside the fence, and what only a robot in the barracks would see.
TEST(MiniMagic, PioneersMapTheAreaTogether) {
  if (instrumented()) GTEST_SKIP() << "half a minute is not enough";
  for (const Trial& trial : trials_of_minimagic()) {
    ASSERT_TRUE(trial.own_map);
    const maps::GridGeometry& geometry = trial.own_map->geometry;
    int free = 0;
    for (std::int64_t row = 0; row < maps::rows(geometry); ++row)
      for (std::int64_t column = 0; column < maps::columns(geometry); ++column) {
        const glm::dvec2 p = maps::middle(geometry, {column, row});
        if (std::abs(p.x) > 5.9 || std::abs(p.y) > 3.9) continue;
        free += trial.own_map->at({column, row}) == maps::Cell::free;
      }
    EXPECT_GT(free * geometry.cell * geometry.cell, 0.88 * 11.8 * 7.8) << "square metres";
    for (std::size_t i = 0; i < trial.tracks.size(); ++i) {
      if (!trial.tracks[i].name.starts_with("pioneer")) continue;
      const base::Pose& X = trial.tracks[i].poses.back();
      EXPECT_EQ(trial.own_map->at(maps::cell_at(geometry, {X.x, X.y})), maps::Cell::free) << trial.tracks[i].name;
    }
  }
}

TEST(MiniMagic, TargetsAndThreatsAreLocated) {
  if (instrumented()) GTEST_SKIP() << "half a minute is not enough";
  const world::World world = world_of(read_scenario(SF_SOURCE_DIR "/experiments/minimagic.toml"));
  for (const Trial& trial : trials_of_minimagic()) {
    std::set<std::uint32_t> found;
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
}

}  // namespace
}  // namespace sf::scenarios
