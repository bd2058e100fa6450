// Inductive loops: passages, occupancy and speeds against plain geometry, between ticks, and vehicles that appear.

#include "sensors/loop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/time.h"
#include "robots/kinematics.h"
#include "tests/sensors/chance.h"
#include "tests/sensors/host_trial.h"
#include "tests/world/read_world.h"
#include "world/stage/build_world.h"

namespace sf::trial {
namespace {

using base::Pose;

struct LoopReading {
  double count, occupancy, speed, vehicles;
};

/// A post at the origin with `loops`, and cars of 0.4 x 0.2 m at `cars`.
world::World road(const std::string& loops, const std::vector<Pose>& cars) {
  std::string text =
      "define car position( size [0.4 0.2 0.2] velocity_bounds [-20 20 0 0 0 0 -720 720] )\n"
      "position( name \"post\" size [0.1 0.1 2] " +
      loops + " )\n";
  for (const Pose& X : cars)
    text += "car( pose [" + std::to_string(X.x) + " " + std::to_string(X.y) + " " + std::to_string(X.z) + " " +
            std::to_string(X.yaw * 180.0 / M_PI) + "] )\n";
  return world::build_world("road.world", text, {.sensors = sensors::world_file_words()});
}

/// Ticks a world whose cars are where the test puts them.
class Traffic {
 public:
  explicit Traffic(const world::World& world, unsigned threads = 1)
      : world_(world), farm_(world_, host_device(), {.threads = threads}), states_(robots::states_at_load(world_)) {
    farm_.subscribe_all();
  }
  void place(std::uint32_t mover, const Pose& X_WM, const base::Twist& velocity = {}) {
    states_[mover].X_WM = X_WM, states_[mover].velocity = velocity;
  }
  std::vector<LoopReading> tick(double seconds) {
    stamp(seconds);
    return read(farm_.tick(base::nanoseconds(seconds), states_));
  }
  std::vector<LoopReading> sample(double seconds) {
    stamp(seconds);
    return read(farm_.sample(base::nanoseconds(seconds), states_));
  }
  farm::Farm& farm() { return farm_; }

 private:
  void stamp(double seconds) {
    for (base::Report& state : states_) state.time = base::nanoseconds(seconds);
  }
  static std::vector<LoopReading> read(std::span<const base::ReadingBlock> blocks) {
    std::vector<LoopReading> all;
    for (const base::ReadingBlock& b : blocks) all.push_back({b.values[0], b.values[1], b.values[2], b.values[3]});
    return all;
  }
  world::World world_;
  farm::Farm farm_;
  std::vector<base::Report> states_;
};

constexpr const char* kSquare = "loop( pose [3 0 0 0] size [1 1] rate 1 )";

TEST(Loop, CountsAPassageWithItsTimesAndSpeed) {
  for (const int ticks_per_second : {1, 7, 10}) {
    Traffic traffic(road(kSquare, {{}}));
    std::vector<LoopReading> at;
    for (int k = 0; k <= 6 * ticks_per_second; ++k) {
      const double t = static_cast<double>(k) / ticks_per_second;
      traffic.place(1, {t, 0.2, 0, 0}, {1.0, 0.0, 0.0});
      for (const LoopReading& reading : traffic.tick(t)) at.push_back(reading);
    }
    ASSERT_EQ(at.size(), 7u) << ticks_per_second;
    // The front enters at x = 2.3, the rear leaves at x = 3.7.
    for (int t = 0; t <= 6; ++t) {
      EXPECT_EQ(at[t].count, t > 2.3 ? 1.0 : 0.0) << t;
      EXPECT_NEAR(at[t].occupancy, t == 3 || t == 4 ? 0.7 : 0.0, 1e-8) << t;
      EXPECT_EQ(at[t].vehicles, t == 3 ? 1.0 : 0.0) << t;
      EXPECT_EQ(std::isnan(at[t].speed), t != 3) << t;
      EXPECT_TRUE(t != 3 || std::abs(at[t].speed - 1.0) < 1e-9) << at[t].speed;
    }
  }
}

TEST(Loop, AFastVehicleIsSeenBetweenTwoTicks) {
  Traffic traffic(road(kSquare, {{}}));
  traffic.tick(0.0);
  traffic.place(1, {20.0, 0, 0, 0}, {20.0, 0.0, 0.0});
  const LoopReading reading = traffic.tick(1.0).at(0);
  EXPECT_EQ(reading.count, 1.0);
  EXPECT_NEAR(reading.occupancy, 1.4 / 20.0, 1e-8);
  EXPECT_NEAR(reading.speed, 20.0, 1e-9);
}

TEST(Loop, VehiclesTogetherCoverItOnce) {
  Traffic traffic(road(kSquare, {{0, 0.3, 0, 0}, {-0.2, -0.3, 0, 0}}));
  LoopReading last{};
  double covered = 0.0;
  for (int t = 0; t <= 5; ++t) {
    traffic.place(1, {1.0 * t, 0.3, 0, 0}, {1.0, 0.0, 0.0});
    traffic.place(2, {2.0 * t - 0.2, -0.3, 0, 0}, {2.0, 0.0, 0.0});
    last = traffic.tick(t).at(0);
    covered += last.occupancy;
    EXPECT_TRUE(t != 2 || std::abs(last.speed - 2.0) < 1e-9) << "the faster one enters at 1.25 s";
  }
  EXPECT_EQ(last.count, 2.0);
  // The faster one covers it from 1.25 to 1.95 s, the other from 2.3 to 3.7 s.
  EXPECT_NEAR(covered, 0.7 + 1.4, 1e-8);
}

TEST(Loop, OverlapOfVehiclesIsCountedOnceInTheOccupancy) {
  Traffic traffic(road(kSquare, {{2.0, 0.3, 0, 0}, {2.1, -0.3, 0, 0}}));
  traffic.tick(0.0);
  traffic.place(1, {4.0, 0.3, 0, 0}, {2.0, 0.0, 0.0});
  traffic.place(2, {4.1, -0.3, 0, 0}, {2.0, 0.0, 0.0});
  // From 0.15 to 0.85 s, and from 0.1 to 0.8 s.
  EXPECT_NEAR(traffic.tick(1.0).at(0).occupancy, 0.75, 1e-8);
}

TEST(Loop, VehiclesThatStandOnItAtTheStartAreNotCounted) {
  Traffic traffic(road(kSquare, {{3.6, 0, 0, 0}}));
  const LoopReading first = traffic.tick(0.0).at(0);
  EXPECT_EQ(first.count, 0.0);
  EXPECT_EQ(first.vehicles, 1.0);
  EXPECT_EQ(first.occupancy, 1.0);
  EXPECT_EQ(traffic.tick(1.0).at(0).occupancy, 1.0) << "at rest";
}

TEST(Loop, VehiclesThatAppearAreCountedWithoutASpeed) {
  Traffic traffic(road(kSquare, {{50, 0, 0, 0}, {3, 0, 0, 0}}));
  traffic.farm().set_absent(2, true);
  traffic.tick(0.0);
  traffic.place(1, {3, 0.3, 0, 0});
  const LoopReading relocated = traffic.tick(1.0).at(0);
  EXPECT_EQ(relocated.count, 1.0);
  EXPECT_TRUE(std::isnan(relocated.speed));
  traffic.farm().set_absent(2, false);
  EXPECT_EQ(traffic.tick(2.0).at(0).count, 2.0);
  traffic.place(1, {90, 0.3, 0, 0});
  traffic.farm().set_absent(2, true);
  const LoopReading gone = traffic.tick(3.0).at(0);
  EXPECT_EQ(gone.count, 2.0);
  EXPECT_EQ(gone.vehicles, 0.0);
}

TEST(Loop, IgnoresItsCarrierAndOtherLevels) {
  Traffic traffic(road("loop( size [1 1] ) loop( pose [3 0 0 0] size [1 1] )", {{3, 0, 0.6, 0}}));
  const auto all = traffic.tick(0.0);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].vehicles, 0.0) << "the post";
  EXPECT_EQ(all[1].vehicles, 0.0) << "on a bridge";
}

/// A reading between ticks changes no later one, except for the interval since the last reading.
TEST(Loop, ReadingsBetweenTicksAgreeWithTicks) {
  const auto world = road("loop( pose [3 0 0 0] size [1 1] rate 4 )", {{}});
  Traffic sampled(world), ticked(world);
  sampled.tick(0.0), ticked.tick(0.0);
  for (int quarter = 1; quarter <= 24; ++quarter) {
    const double t = 0.25 * quarter;
    const base::Twist v{1.0, 0.0, 0.1};
    const Pose X = robots::advance({0, -0.3, 0, -0.1}, v, t);
    for (Traffic* traffic : {&sampled, &ticked}) traffic->place(1, X, v);
    const LoopReading a = (quarter % 4 == 0 ? sampled.tick(t) : sampled.sample(t)).at(0), b = ticked.tick(t).at(0);
    EXPECT_EQ(a.count, b.count) << t;
    EXPECT_NEAR(a.occupancy, b.occupancy, 1e-6) << t;
    EXPECT_EQ(a.vehicles, b.vehicles) << t;
  }
}

/// Whether two rectangles overlap, by the separating axis theorem.
bool rectangles_overlap(const Pose& X_WA, glm::dvec2 a, const Pose& X_WB, glm::dvec2 b) {
  const auto apart = [](const Pose& X, glm::dvec2 h, const Pose& Y, glm::dvec2 k) {
    const Pose X_XY = base::compose(base::inverse(X), Y);
    const double c = std::abs(std::cos(X_XY.yaw)), s = std::abs(std::sin(X_XY.yaw));
    return std::abs(X_XY.x) > h.x + c * k.x + s * k.y || std::abs(X_XY.y) > h.y + s * k.x + c * k.y;
  };
  return !apart(X_WA, a, X_WB, b) && !apart(X_WB, b, X_WA, a);
}

TEST(Loop, OverlapsAsPlainGeometryStates) {
  Chance chance(5);
  const world::World world = road("", {{}});
  int overlaps = 0;
  for (int i = 0; i < 5000; ++i) {
    const sensors::LoopSize size{chance.between(0.05, 1.5), chance.between(0.05, 1.5)};
    const Pose X_WL{chance.between(-1, 1), chance.between(-1, 1), 0, chance.between(-4, 4)};
    const Pose X_WM{chance.between(-1, 1), chance.between(-1, 1), 0, chance.between(-4, 4)};
    const bool expected = rectangles_overlap(X_WL, {0.5 * size.length, 0.5 * size.width}, X_WM, {0.2, 0.1});
    overlaps += expected;
    EXPECT_EQ(sensors::covers(size, X_WL, world.movers[1], X_WM), expected) << i;
  }
  EXPECT_GT(overlaps, 500);
  EXPECT_LT(overlaps, 4500);
}

/// Cars on arcs: occupancy and count against samples every 0.5 ms.
TEST(Loop, OccupancyOfArcsMatchesSamples) {
  Chance chance(8);
  double passages = 0.0;
  for (int i = 0; i < 80; ++i) {
    const Pose start{chance.between(1.0, 2.5), chance.between(-1, 1), 0, chance.between(-1, 1)};
    const base::Twist v{chance.between(0.5, 3), 0.0, chance.between(-1, 1)};
    Traffic traffic(road("loop( pose [3 0 0 30] size [0.8 0.5] rate 1 )", {start}));
    const auto on = [&](double t) {
      return rectangles_overlap({3, 0, 0, M_PI / 6}, {0.4, 0.25}, robots::advance(start, v, t), {0.2, 0.1});
    };
    LoopReading reading{};
    for (int tick = 0; tick <= 5; ++tick) {
      traffic.place(1, robots::advance(start, v, 0.2 * tick), v);
      for (const LoopReading& r : traffic.tick(0.2 * tick)) reading = r;
    }
    int covered = 0, entries = 0;
    for (int k = 0; k < 2000; ++k) covered += on(5e-4 * k), entries += !on(5e-4 * k) && on(5e-4 * (k + 1));
    EXPECT_NEAR(reading.occupancy, 5e-4 * covered, 1e-3) << i;
    EXPECT_EQ(reading.count, entries) << i;
    EXPECT_TRUE(entries == 0 || std::abs(reading.speed - v.forward) < 1e-6) << i;
    passages += entries;
  }
  EXPECT_GT(passages, 20);
}

TEST(Loop, ReadingsAreTheSameForAnyNumberOfThreads) {
  std::string loops;
  for (int i = 0; i < 200; ++i) loops += "loop( pose [" + std::to_string(0.1 * i) + " 0 0 0] size [0.5 0.5] )\n";
  std::vector<Pose> cars;
  for (int i = 0; i < 30; ++i) cars.push_back({0.7 * i, 0.1 * (i % 5), 0, 0.2 * i});
  const world::World world = road(loops, cars);
  Traffic one(world, 1), three(world, 3);
  for (int k = 0; k <= 20; ++k)
    for (Traffic* traffic : {&one, &three}) {
      for (std::uint32_t m = 0; m < cars.size(); ++m) {
        const base::Twist v{0.3 + 0.1 * m, 0.0, 0.0};
        traffic->place(m + 1, robots::advance(cars[m], v, 0.15 * k), v);
      }
      traffic->tick(0.15 * k);
    }
  EXPECT_EQ(one.farm().hash(), three.farm().hash());
}

TEST(Loop, OneThatMovesWithARobotIsWarnedOf) {
  const auto warnings = [](const std::string& carrier) {
    return world::warnings_of(world::build_world("road.world", carrier, {.sensors = sensors::world_file_words()}));
  };
  EXPECT_EQ(
      warnings("position( name \"post\" loop( ) )"),
      "1: 'loop:0' moves with 'post', and link-speed takes it to stay where it starts; mount it on a robot at rest "
      "(ctrl \"none\") or on an object (tag<N>)\n");
  EXPECT_EQ(warnings("position( ctrl \"none\" loop( ) )"), "");
  EXPECT_EQ(warnings("model( name \"tag5\" loop( ) )"), "");
}

TEST(Loop, InvalidSettingsAreRejected) {
  expect_refused("loop", {setting("size", {2})}, 8, "[along across]");
  expect_refused("loop", {setting("size", {0, 1})}, 8, "two lengths from 1 mm to 1 km");
  expect_refused("loop", {setting("size", {1, 2000})}, 8, "two lengths from 1 mm to 1 km");
  expect_refused("loop", {setting("rate", {0})}, 8, "'rate'");
}

}  // namespace
}  // namespace sf::trial
