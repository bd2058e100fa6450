// The experiment `vesim`: a short run of a car in traffic, whose tracks and position are compared with the truth.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "scenarios/vesim_runs.h"
#include "tests/refusal.h"

namespace sf::scenarios {
namespace {

VesimRun run_for(double duration, unsigned threads) {
  gpu::Device device;
  const ExperimentOptions options{.threads = threads};
  Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/vesim.toml");
  scenario.duration = duration;
  return run_vesim({*find_experiment("vesim"), scenario, options, device, {}}, 1);
}

VesimCell near_and_ahead(const VesimRun& run, std::string_view sensors) {
  const auto choice = std::ranges::find(kVesimChoices, sensors, &VesimChoice::name);
  const VesimTracks& tracks = run.tracks[static_cast<std::size_t>(choice - kVesimChoices.begin())];
  VesimCell sum;
  for (std::size_t i = 0; i < 3; ++i) {
    const VesimCell& cell = tracks.cells[0][i];
    sum.targets += cell.targets, sum.found += cell.found;
    sum.position_squares += cell.position_squares, sum.velocity_squares += cell.velocity_squares;
  }
  return sum;
}

TEST(VesimExperiment, FusionFindsCarsAndLocatesItsOwnBetterThanEitherAlone) {
  const VesimRun run = run_for(12.0, 2);
  EXPECT_EQ(run.contacts, 0u);
  const VesimCell all = near_and_ahead(run, "all"), both = near_and_ahead(run, "lidars and radar"),
                  lidars = near_and_ahead(run, "lidars"), radar = near_and_ahead(run, "radar"),
                  camera = near_and_ahead(run, "camera"), cheap = near_and_ahead(run, "camera and radar");
  ASSERT_GT(both.targets, 100u);
  for (const VesimCell* each : {&all, &radar, &camera}) EXPECT_EQ(both.targets, each->targets) << "the same truth";
  EXPECT_GT(10 * both.found, 9 * both.targets);
  EXPECT_GE(both.found, lidars.found);
  EXPECT_GT(10 * all.found, 9 * all.targets);
  EXPECT_GT(10 * camera.found, 5 * camera.targets) << "by its depths alone";
  EXPECT_GE(cheap.found, camera.found);
  const auto rms = [](double squares, const VesimCell& cell) {
    return std::sqrt(squares / static_cast<double>(cell.found));
  };
  EXPECT_LT(rms(both.position_squares, both), rms(radar.position_squares, radar)) << "lidars see where cars are";
  EXPECT_LT(rms(both.velocity_squares, both), 0.8) << "m/s: the short run is too short to rank the sets";
  EXPECT_GT(run.gps.readings, 30u);
  EXPECT_LT(4.0 * run.fused.squares / static_cast<double>(run.fused.readings),
            run.gps.squares / static_cast<double>(run.gps.readings))
      << "half the error";
  EXPECT_LT(run.tracks[0].ghosts, run.tracks[0].readings);
}

TEST(VesimExperiment, IsTheSameOnAnyNumberOfThreads) {
  const VesimRun once = run_for(5.5, 1), again = run_for(5.5, 3);
  EXPECT_EQ(std::memcmp(&once, &again, sizeof once), 0);
  EXPECT_NE(once.hash, 0u);
}

TEST(VesimExperiment, NeedsItsCar) {
  gpu::Device device;
  const ExperimentOptions options{.threads = 1};
  const Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/tree.toml");
  const ExperimentContext context{*find_experiment("vesim"), scenario, options, device, {}};
  expect_in("no car 'ego'; expected worlds/vesim/vesim.world", refusal_of([&] { run_vesim(context, 1); }));
}

}  // namespace
}  // namespace sf::scenarios
