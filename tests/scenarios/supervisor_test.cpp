#include "scenarios/supervisor.h"

#include <gtest/gtest.h>

#include "scenarios/trial.h"

namespace sf::scenarios {
namespace {

/// A world of one mover, with only a number and a tick.
world::World one_mover() {
  world::World world;
  world.movers.resize(1);
  world.interval = 0.1;
  return world;
}

/// Drives along x to `far`, then stops in contact with these sectors.
struct Ride {
  world::World world = one_mover();
  Supervisor supervisor;
  base::Report report;
  explicit Ride(const SupervisorSettings& settings, double far = 1.0) : supervisor(world, settings) {
    report.velocity.forward = 0.1;
    for (; report.X_WM.x < far; report.X_WM.x += 0.01) look(false);
    report.velocity = {};
  }
  std::vector<Supervisor::Intervention> look(bool contact) {
    const std::uint8_t contacts[] = {contact};
    const auto helps = supervisor.update({.reports = {&report, 1}, .contacts = contacts});
    return {helps.begin(), helps.end()};
  }
  /// Ticks in contact until the intervention; 1000: none.
  int wait(Supervisor::Intervention& help) {
    for (int i = 1; i < 1000; ++i)
      if (const auto helps = look(true); !helps.empty()) return help = helps[0], i;
    return 1000;
  }
};

TEST(Supervisor, RescuesARobotThatHasWaitedLongEnough) {
  Ride ride({.patience = 5.0});
  Supervisor::Intervention help;
  EXPECT_NEAR(ride.wait(help), 50, 1);
  EXPECT_EQ(help.mover, 0u);
}

TEST(Supervisor, NoSupervisorByDefault) {
  Ride ride({});
  Supervisor::Intervention help;
  EXPECT_EQ(ride.wait(help), 1000);
}

/// Contact while moving, or a stop without contact, is not waiting.
TEST(Supervisor, IgnoresRobotsThatDoNotWait) {
  Ride ride({.patience = 1.0});
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(ride.look(false).empty());
  ride.report.velocity.turn = 0.2;
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(ride.look(true).empty());
  ride.report.velocity = {};
  for (int i = 0; i < 9; ++i) EXPECT_TRUE(ride.look(true).empty());
  ride.look(false);
  for (int i = 0; i < 9; ++i) EXPECT_TRUE(ride.look(true).empty()) << "the wait starts again";
}

TEST(Supervisor, MovesTheRobotBackAlongItsPath) {
  Ride ride({.patience = 1.0, .back = 0.15});
  Supervisor::Intervention help;
  ride.wait(help);
  EXPECT_NEAR(ride.report.X_WM.x - help.X_WM.x, 0.15, 0.021);
  EXPECT_EQ(help.X_WM.y, 0.0);
  // Not farther back than its path.
  Ride brief({.patience = 1.0, .back = 0.15}, 0.05);
  brief.wait(help);
  EXPECT_EQ(help.X_WM.x, 0.0);
}

TEST(Supervisor, TurnsTheRobotAwayFromTheContact) {
  for (const bool left : {true, false}) {
    Ride ride({.patience = 1.0, .turn = 0.5});
    ride.report.contact_mask = left ? 1u << 2 : 1u << (base::kContactSectors - 3);
    Supervisor::Intervention help;
    ride.wait(help);
    EXPECT_NEAR(help.X_WM.yaw, left ? -0.5 : 0.5, 1e-12);
  }
}

/// The thesis' avoidance scrapes walls and then waits forever; with a supervisor it continues.
TEST(Supervisor, LetsTheThesisAvoidanceContinue) {
  Scenario scenario = read_scenario(SF_SOURCE_DIR "/experiments/mapping.toml");
  scenario.duration = 120.0;
  gpu::Device device;
  const world::World world = world_of(scenario);
  const Trial alone = run_trial(scenario, world, device, {});
  const Trial interventions = run_trial(scenario, world, device, {.supervisor = {.patience = 5.0}});
  ASSERT_GT(alone.counts[0].contacts, 0u) << "it did not scrape: this test needs another start";
  EXPECT_EQ(alone.interventions[0], 0u);
  EXPECT_GT(interventions.interventions[0], 0u);
  EXPECT_GT(interventions.counts[0].travelled, 1.3 * alone.counts[0].travelled);
  EXPECT_LT(interventions.dead_ends[0].stuck(), alone.dead_ends[0].stuck());
  EXPECT_LT(interventions.counts[0].travelled, 0.1 * 120.0) << "being carried is not driving";
}

}  // namespace
}  // namespace sf::scenarios
