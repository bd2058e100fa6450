// Speeds of links: what probes and loops measure, consistency, and independence of the update interval.

#include "robots/estimation/link_speed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "robots/estimation/chi_square.h"

namespace sf::estimation {
namespace {

TEST(LinkSpeed, NothingIsKnownBeforeTheFirstReport) {
  LinkSpeed link({});
  EXPECT_FALSE(link.update(10.0, 0.04));
  link.add_probe({.metres = 1.0, .seconds = 0.0});
  EXPECT_FALSE(link.update(10.0, 0.04)) << "no time on the link";
  EXPECT_FALSE(link.known());
  link.add_probe({.metres = 4.0, .seconds = 10.0});
  EXPECT_TRUE(link.update(10.0, 0.04));
  EXPECT_TRUE(link.known());
  EXPECT_DOUBLE_EQ(link.speed(), 0.4);
  EXPECT_DOUBLE_EQ(link.variance(), 0.04) << "one vehicle for one correlation time";
}

/// Distances and times are added: vehicles that stay longer count more.
TEST(LinkSpeed, IsTheDistanceOfAllOverTheirTime) {
  LinkSpeed link({});
  link.add_probe({.metres = 10.0, .seconds = 10.0});
  link.add_probe({.metres = 0.0, .seconds = 30.0});
  link.update(40.0, 0.04);
  EXPECT_DOUBLE_EQ(link.speed(), 0.25);
  EXPECT_DOUBLE_EQ(link.variance(), 0.01);
}

TEST(LinkSpeed, NeverBelowZero) {
  LinkSpeed link({});
  link.add_probe({.metres = -1.0, .seconds = 10.0});
  link.update(10.0, 0.04);
  EXPECT_EQ(link.speed(), 0.0);
}

/// Half of the vehicles drive at 1 m/s, half at 3 m/s: a loop sees the fast ones three times as often.
TEST(LinkSpeed, LoopsAreConvertedToTheSpaceMean) {
  const double time_mean = (1.0 * 1.0 + 3.0 * 3.0) / (1.0 + 3.0);
  EXPECT_NEAR(space_mean(time_mean, 1.0), 2.0, 1e-12);
  EXPECT_EQ(space_mean(1.0, 0.0), 1.0);
  EXPECT_EQ(space_mean(1.0, 100.0), 0.5) << "a spread that does not fit the mean";
  LinkSpeed link({.spot = 0.3});
  link.add_loop(time_mean, 4.0);
  EXPECT_TRUE(link.update(1.0, 1.0));
  EXPECT_NEAR(link.speed(), 2.0, 1e-12);
  EXPECT_NEAR(link.variance(), 1.0 / 4.0 + 0.09, 1e-12);
}

TEST(LinkSpeed, TheVarianceDoesNotDependOnTheIntervalOfUpdates) {
  const auto after = [](int updates) {
    LinkSpeed link({.spread = 0.2, .drift = 0.02});
    for (int k = 0; k < updates; ++k) {
      link.add_probe({.metres = 30.0 / updates, .seconds = 60.0 / updates});
      link.update(60.0 / updates, 0.04);
    }
    return link.variance();
  };
  EXPECT_NEAR(after(60), after(6), 0.25 * after(6));
}

/// Vehicles with speeds of their own for each correlation time, and loops at places with speeds of their own.
double normalized_error(std::uint64_t seed, bool probes, bool loops) {
  std::mt19937_64 bits(seed);
  std::normal_distribution<double> normal;
  const LinkSpeedOptions options{.spread = 0.1, .drift = 0.01, .correlation = 10.0, .spot = 0.05};
  LinkSpeed link(options);
  double truth = 3.0;
  for (int k = 0; k < 30; ++k) {
    truth += options.drift * std::sqrt(10.0) * normal(bits);
    for (int vehicle = 0; probes && vehicle < 1 + k % 3; ++vehicle)
      link.add_probe({.metres = 10.0 * (truth + options.spread * normal(bits)), .seconds = 10.0});
    double sum = 0.0;
    const int passed = loops && k % 2 == 0 ? 4 : 0;
    for (int vehicle = 0; vehicle < passed; ++vehicle) sum += truth + options.spread * normal(bits);
    // At 3 m/s, time-mean and space-mean differ by 3 mm/s, far less than the noise.
    if (passed > 0) link.add_loop(sum / passed + options.spot * normal(bits), passed);
    link.update(10.0, options.spread * options.spread);
  }
  return (link.speed() - truth) * (link.speed() - truth) / link.variance();
}

TEST(LinkSpeed, VarianceIsConsistentOver100Seeds) {
  constexpr int kSeeds = 100;
  for (const auto& [probes, loops] : {std::pair{true, false}, std::pair{false, true}, std::pair{true, true}}) {
    double sum = 0.0;
    for (int seed = 1; seed <= kSeeds; ++seed) sum += normalized_error(static_cast<std::uint64_t>(seed), probes, loops);
    EXPECT_GT(sum, chi_square_limit(kSeeds, 0.975)) << probes << loops;
    EXPECT_LT(sum, chi_square_limit(kSeeds, 0.025)) << probes << loops;
  }
}

TEST(SpeedSpread, IsLearntFromVehiclesThatShareALink) {
  SpeedSpread spread(0.2);
  EXPECT_DOUBLE_EQ(spread.variance(), 0.2 * 0.2);
  spread.add(std::vector<ProbeTravel>{{.metres = 9.0, .seconds = 10.0}});
  spread.add(std::vector<ProbeTravel>{});
  EXPECT_DOUBLE_EQ(spread.variance(), 0.2 * 0.2) << "one vehicle shows nothing about the others";
  std::mt19937_64 bits(3);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 3000; ++k) {
    std::vector<ProbeTravel> travels;
    for (int vehicle = 0; vehicle < 3; ++vehicle)
      travels.push_back({.metres = 10.0 * (1.0 + 0.1 * normal(bits)), .seconds = 10.0});
    spread.add(travels);
  }
  EXPECT_NEAR(spread.variance(), 0.01, 0.001);
}

}  // namespace
}  // namespace sf::estimation
