// SimVille's experiment without sensors: a convoy of five, 43 robots on tours, one that parks.

#include "tests/control/traffic.h"
#include "tests/instrumented.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

namespace sf::traffic {
namespace {

constexpr std::uint32_t kParks = 5, kTours = 43;

/// Robots 0 to 4 are the convoy, 5 parks, the others tour.
void add_cast(Streets& t, std::uint64_t seed) {
  t.world.lights = world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world").lights;
  const Setting gap{"gap", 0.1, ""};
  t.add({5.4, 0.75, 0, 0}, "route",
        go({6, 7, 8, 2}, {{"loop", true, ""}, {"speed", 0.18, ""}, {"pass", false, ""}, gap}));
  for (int k = 1; k < 5; ++k) t.add({5.4 - 0.6 * k, 0.75, 0, 0}, "convoy", {{"leader", double(k), ""}});
  t.add({3.15, 5.0, 0, -M_PI / 2}, "route", {{"park", std::string("13.4"), ""}, gap});
  const std::vector<world::Mover> there = t.world.movers;
  std::uint32_t tours = 0;
  for (const Pose& X : control::start_poses(t.roads, kTours + 12, seed, 0.5)) {
    const bool clear = std::none_of(there.begin(), there.end(), [&](const world::Mover& mover) {
      return std::hypot(X.x - mover.X_WM.x, X.y - mover.X_WM.y) < 0.5;
    });
    if (clear && tours++ < kTours) t.add(X, "route", {{"tour", true, ""}, gap});
  }
  ASSERT_GE(tours, kTours);
  t.begin(seed);
}

struct Town {
  int contacts = 0;
  double longest_rest = 0.0;               // [s] for the robots that do not park
  std::uint64_t goals = 0, least = ~0ull;  // for the robots with goals
  std::array<double, 5> driven{};          // [m] driven by the members of the convoy
  std::vector<double> gaps;                // [m] from each member to the one ahead of it, every second
  double gap(double quantile) {
    const auto at = static_cast<std::size_t>(quantile * static_cast<double>(gaps.size() - 1));
    std::sort(gaps.begin(), gaps.end());
    return gaps[at];
  }
};

Town town(std::uint64_t seed, double seconds) {
  Streets t;
  add_cast(t, seed);
  const auto count = static_cast<std::uint32_t>(t.controllers.size());
  std::vector<double> rests(count);
  Town town;
  for (int i = 0; i < 10.0 * seconds; ++i) {
    t.tick();
    for (std::uint32_t k = 0; k < count; ++k) {
      const Twist& v = t.fleet->reports()[k].velocity;
      rests[k] = v.forward == 0.0 && v.turn == 0.0 ? rests[k] + 0.1 : 0.0;
      if (k != kParks) town.longest_rest = std::max(town.longest_rest, rests[k]);
      if (k < 5) town.driven[k] += 0.1 * std::abs(v.forward);
      if (k > 0 && k < 5 && i % 10 == 0) town.gaps.push_back(t.distance(k, k - 1));
    }
  }
  town.contacts = t.contacts;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (k > 0 && k <= kParks) continue;
    town.goals += t.route(k).reached();
    town.least = std::min(town.least, t.route(k).reached());
  }
  EXPECT_TRUE(t.controllers[kParks]->done()) << seed;
  return town;
}

// A route that is cut anywhere in the car park continues from the cut.
TEST(Town, RouteCutInTheCarParkStaysContinuous) {
  Streets t;
  const control::LaneCorridors corridors(t.roads, t.world, {});
  const auto start = locate_on_lane(corridors, on_lane(t.roads, "11.2", 0.1));
  ASSERT_TRUE(start.has_value());
  control::RoutePlan whole = plan_from(corridors, *start);
  ASSERT_TRUE(extend(corridors, whole, *find_checkpoint(t.roads, 8)));
  int in_zone = 0;
  for (double s = 0.0; s < length_of(whole); s += 0.05) {
    control::RoutePlan plan = whole;
    in_zone += corridors.way(plan.legs[leg_at(plan, s)].way).in_zone;
    cut_after(corridors, plan, s);
    ASSERT_TRUE(extend(corridors, plan, *find_checkpoint(t.roads, 9))) << s;
    for (std::size_t i = 1; i < plan.legs.size(); ++i) {
      const auto &a = plan.legs[i - 1], &b = plan.legs[i];
      const glm::dvec2 gap = point_on(corridors.way(a.way), a.to) - point_on(corridors.way(b.way), b.from);
      ASSERT_LT(length(gap), 0.05) << s << " leg " << i;
    }
  }
  EXPECT_GT(in_zone, 3);
}

TEST(Town, NoRobotStopsPermanentlyAndTheConvoyContinues) {
  for (std::uint64_t seed = 1; seed <= (instrumented() ? 1u : 3u); ++seed) {
    const Town t = town(seed, 500.0);
    EXPECT_EQ(t.contacts, 0) << seed;
    EXPECT_LT(t.longest_rest, 250.0) << seed;
    EXPECT_GT(t.goals, 80u) << seed;
    for (const double driven : t.driven) EXPECT_GT(driven, 25.0) << seed;
  }
}

// Half an hour of simulated time takes half a minute, so it runs only on request.
TEST(Town, DISABLED_HalfAnHour) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Town t = town(seed, 1800.0);
    EXPECT_EQ(t.contacts, 0) << seed;
    EXPECT_LT(t.longest_rest, 300.0) << seed;
    EXPECT_GT(t.least, 0u) << seed;
    for (const double driven : t.driven) EXPECT_GT(driven, 90.0) << seed;
    fmt::print(
        "seed {}: {} contacts, longest rest {:.0f} s, {} checkpoints, fewest {}, gaps 50 % {:.2f} 75 % {:.2f} "
        "90 % {:.2f} m, driven {:.0f} to {:.0f} m\n",
        seed, t.contacts, t.longest_rest, t.goals, t.least, t.gap(0.5), t.gap(0.75), t.gap(0.9),
        *std::min_element(t.driven.begin(), t.driven.end()), *std::max_element(t.driven.begin(), t.driven.end()));
  }
}

}  // namespace
}  // namespace sf::traffic
