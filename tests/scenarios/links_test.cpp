// The experiment `links`: estimates of a corridor and of SimVille against the truth of all vehicles.

#include <gtest/gtest.h>

#include <cmath>

#include "scenarios/link_runs.h"

namespace sf::scenarios {
namespace {

/// RMS error of one set [m/s], and the number of cells.
std::pair<double, int> rms_of_set(const LinkRun& run, std::size_t set) {
  double squares = 0.0;
  int cells = 0;
  for (const LinkCell& cell : run.cells) {
    if (std::isnan(cell.truth) || std::isnan(cell.speeds[set])) continue;
    squares += (cell.speeds[set] - cell.truth) * (cell.speeds[set] - cell.truth), ++cells;
  }
  return {std::sqrt(squares / cells), cells};
}

TEST(LinksExperiment, ProbesReachTheTarget) {
  gpu::Device device;
  const ExperimentOptions options{.threads = 1};
  Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/links.toml");
  scenario.duration = 180.0;
  const ExperimentContext context{*find_experiment("links"), scenario, options, device, {}};
  const LinkRun corridor = run_corridor(context, 2, 900.0), town = run_town_links(context, 2);
  ASSERT_EQ(corridor.links.size(), 4u);
  ASSERT_EQ(corridor.cells.size(), 4u * 10u) << "a cell per link and minute after the warm-up";
  EXPECT_EQ(town.vehicles, 48u);
  ASSERT_EQ(town.links.size(), 25u);
  const std::size_t thirty = std::size(kLinkSets) - 1;
  ASSERT_EQ(kLinkSets[thirty].percent, 30);
  const auto [error, cells] = rms_of_set(corridor, thirty);
  EXPECT_EQ(cells, 40);
  EXPECT_LT(error, corridor_plan().target);
  const auto [town_error, town_cells] = rms_of_set(town, thirty - 1);
  EXPECT_GT(town_cells, 30);
  EXPECT_LT(town_error, 0.06);
}

TEST(LinksExperiment, SharesOfProbes) {
  EXPECT_EQ(probes_of({0, true}, 60), 0u);
  EXPECT_EQ(probes_of({5, false}, 60), 3u);
  EXPECT_EQ(probes_of({5, false}, 48), 2u);
  EXPECT_EQ(probes_of({5, false}, 3), 1u) << "at least one";
  EXPECT_EQ(probes_of({30, false}, 48), 14u);
}

}  // namespace
}  // namespace sf::scenarios
