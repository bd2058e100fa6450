#include "scenarios/run_metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/sensor_type.h"
#include "tests/device.h"
#include "world/lights.h"
#include "world/roads/network.h"

namespace sf::scenarios {
namespace {

/// SimVille with robots at rest, and a tick record that tests fill in.
class Town {
 public:
  Town() : world_(load()), simulation_(world_, device(), without_controllers()), metrics_(world_, simulation_) {
    for (std::uint32_t m = 0; m < world_.movers.size(); ++m) reports_.push_back({m, 0, world_.movers[m].X_WM, {}});
    commands_.resize(reports_.size());
    contacts_.resize(reports_.size());
  }

  const world::World& world() const { return world_; }
  const Simulation& simulation() const { return simulation_; }
  const RunMetrics& metrics() const { return metrics_; }

  void look(double seconds, const base::Pose& first, bool contact = false, double speed = 0.0) {
    reports_[0].X_WM = first;
    reports_[0].velocity.forward = speed;
    contacts_[0] = contact;
    metrics_.update({tick_++, std::llround(1e9 * seconds), reports_, commands_, contacts_, {}});
  }

  /// Moves robot 0 at one time from half a metre before a line to half a metre past it.
  /// @return red lights passed
  std::uint64_t pass(const base::Pose& X_WL, double seconds) {
    const std::uint64_t before = metrics_.red_lights_passed();
    for (int i = -10; i <= 10; ++i) look(seconds, base::compose(X_WL, {0.05 * i, 0.0, 0.0, 0.0}));
    return metrics_.red_lights_passed() - before;
  }

 private:
  static world::World load() {
    return world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world", {.sensors = sensors::world_file_words()});
  }
  static SimulationOptions without_controllers() {
    SimulationOptions options;
    options.actor.controller.name.clear();
    return options;
  }

  world::World world_;
  Simulation simulation_;
  RunMetrics metrics_;
  std::uint64_t tick_ = 0;
  std::vector<base::Report> reports_;
  std::vector<base::Twist> commands_;
  std::vector<std::uint8_t> contacts_;
};

/// Returns a governed way-point, with x in driving direction.
base::Pose line_of(const Town& town, const std::string& name) {
  unsigned a = 0, b = 0, c = 0;
  EXPECT_EQ(std::sscanf(name.c_str(), "%u.%u.%u", &a, &b, &c), 3);
  const world::RoadNetwork& roads = *town.simulation().roads();
  const auto at = world::find_point(
      roads, {static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b), static_cast<std::uint16_t>(c)});
  EXPECT_TRUE(at) << name;
  const glm::dvec2 p = world::position_of(roads, *at);
  return {p.x, p.y, 0.0, *world::yaw_of(roads, *at)};
}

TEST(RunMetrics, OnlyPassesAtRedAreCounted) {
  Town town;
  ASSERT_NE(town.simulation().roads(), nullptr);
  ASSERT_FALSE(town.world().lights.empty());
  int red_lights_passed = 0, others = 0;
  for (const world::Light& light : town.world().lights)
    for (const std::string& name : light.points) {
      const base::Pose X_WL = line_of(town, name);
      for (double t = 0.5; t < 30.0; t += 3.0) {
        const bool red = world::signal_at(light, t).state == world::LightState::red;
        EXPECT_EQ(town.pass(X_WL, t), red ? 1u : 0u) << name << " " << t;
        (red ? red_lights_passed : others) += 1;
      }
    }
  EXPECT_GT(red_lights_passed, 0);
  EXPECT_GT(others, 0);
}

TEST(RunMetrics, OtherLanesAndTheOppositeDirectionDoNotCount) {
  Town town;
  const world::Light& light = town.world().lights[0];
  double red = 0.0;
  while (world::signal_at(light, red).state != world::LightState::red) red += 0.25;
  const base::Pose X_WL = line_of(town, light.points.at(0));
  EXPECT_EQ(town.pass(X_WL, red), 1u);
  EXPECT_EQ(town.pass(base::compose(X_WL, {0.0, 0.4, 0.0, 0.0}), red), 0u);   // the adjacent lane
  EXPECT_EQ(town.pass(base::compose(X_WL, {0.0, 0.0, 0.0, M_PI}), red), 0u);  // back over it
  // At the line, and slightly beyond it, does not count as passed.
  const std::uint64_t before = town.metrics().red_lights_passed();
  double front = 0.0;
  for (const world::Segment& side : town.world().movers[0].body)
    if (side.stops_robots) front = std::max({front, side.a.x, side.b.x});
  for (const double x : {-0.5, -front, 0.9 * kPassed - front}) town.look(red, base::compose(X_WL, {x, 0.0, 0.0, 0.0}));
  EXPECT_EQ(town.metrics().red_lights_passed(), before);
  town.look(red, base::compose(X_WL, {1.1 * kPassed - front, 0.0, 0.0, 0.0}));
  EXPECT_EQ(town.metrics().red_lights_passed(), before + 1);
}

TEST(CheckpointProgress, ReplacedCheckpointsCountAsPassed) {
  CheckpointProgress goals;
  goals.update(base::kNoId);
  EXPECT_FALSE(goals.any);
  goals.update(3);  // the first has not been passed yet
  EXPECT_TRUE(goals.any);
  EXPECT_EQ(goals.passed, 0u);
  goals.update(3);
  EXPECT_EQ(goals.passed, 0u);
  goals.update(5);
  EXPECT_EQ(goals.passed, 1u);
  goals.update(base::kNoId);  // the last
  goals.update(base::kNoId);
  EXPECT_EQ(goals.passed, 2u);
  goals.update(0);  // an id like any other
  goals.update(7);
  EXPECT_EQ(goals.passed, 3u);
  EXPECT_EQ(goals.now, 7u);
}

TEST(RunMetrics, ContactsAreCountedAtTheirStart) {
  Town town;
  const base::Pose X = town.world().movers[0].X_WM;
  for (const bool contact : {false, true, true, false, true, true, true, false}) town.look(0.0, X, contact);
  EXPECT_EQ(town.metrics().of(0).contacts, 2u);
  EXPECT_EQ(town.metrics().contacts(), 2u);
}

/// A full stop is a halt after driving. Creeping is neither, and a longer halt is not a second stop.
TEST(RunMetrics, FullStopsAreCounted) {
  Town town;
  const base::Pose X = town.world().movers[0].X_WM;
  const auto stops = [&](std::initializer_list<double> speeds) {
    const std::uint64_t before = town.metrics().of(0).stops;
    for (const double speed : speeds) town.look(0.0, X, false, speed);
    return town.metrics().of(0).stops - before;
  };
  EXPECT_EQ(stops({0.0, 0.0}), 0u) << "it never drove";
  EXPECT_EQ(stops({0.9 * kDriving, 0.0}), 0u) << "it only crept";
  EXPECT_EQ(stops({kDriving, 0.9 * kDriving, 1.1 * kStanding, 0.0, 0.0}), 1u);
  EXPECT_EQ(stops({0.2, 0.01, 0.2}), 0u) << "slow, but on";
  EXPECT_EQ(stops({0.0, -0.2, kStanding, 0.2, 0.0}), 3u) << "backwards, too";
}

TEST(RunMetrics, DistancesAreSummed) {
  Town town;
  const base::Pose X = town.world().movers[0].X_WM;
  for (int i = 0; i <= 10; ++i) town.look(0.1 * i, base::compose(X, {0.01 * i, 0.0, 0.0, 0.0}));
  EXPECT_NEAR(town.metrics().of(0).travelled, 0.1, 1e-12);
  town.look(1.1, base::compose(X, {5.0, 0.0, 0.0, 0.0}));
  EXPECT_NEAR(town.metrics().of(0).travelled, 0.1, 1e-12) << "placed, not driven";
  EXPECT_EQ(town.metrics().of(1).travelled, 0.0);
}

}  // namespace
}  // namespace sf::scenarios
