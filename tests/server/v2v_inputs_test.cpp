// States that the farm receives, as inputs `v2v` of derived sensors.

#include <gtest/gtest.h>

#include <cmath>

#include "sensors/aggregate.h"
#include "tests/server/fixture.h"

namespace sf::server {
namespace {

constexpr std::size_t kValue = 0, kValid = 1;

/// The room, in which the first robot states the second one's x.
world::World watched_room() {
  world::World world = room();
  world.movers[0].sensors.push_back({.type = "aggregate",
                                     .name = "x",
                                     .settings = {{.key = "inputs", .text = world.movers[1].name + "/v2v"},
                                                  {.key = "quantity", .text = "x_m"},
                                                  {.key = "rate", .numbers = {10.0}},
                                                  {.key = "max_age", .numbers = {0.25}}}});
  return world;
}

struct Watched final : base::Sink {
  void write(const base::TickRecord& record) override {
    for (const base::ReadingBlock& reading : record.readings)
      if (reading.type == sensors::kAggregate) last.assign(reading.values.begin(), reading.values.end());
    other = record.reports[1].X_WM;
  }
  std::vector<double> last;
  base::Pose other;
};

/// Runs both robots for some ticks.
void run_both(server::Fixture& f, RobotClient& second, int ticks) {
  for (int k = 0; k < ticks; ++k) {
    second.receive(f.now);
    second.step(f.now);
    f.run(1);
  }
}

TEST(V2vInputs, AreTheStatesOfATick) {
  server::Fixture f({.world = watched_room()});
  Watched watched;
  f.service->record_to(watched);
  f.run(10);
  ASSERT_EQ(watched.last.size(), 5u);
  EXPECT_EQ(watched.last[kValid], 0.0) << "the other robot has sent no state";
  {
    const auto second = f.make_client(1);
    run_both(f, *second, 20);
    EXPECT_EQ(watched.last[kValid], 1.0);
    EXPECT_NEAR(watched.last[kValue], watched.other.x, 1e-9);
  }
  f.run(2);
  EXPECT_EQ(watched.last[kValid], 1.0) << "the last state, 0.2 s ago";
  f.run(3);
  EXPECT_EQ(watched.last[kValid], 0.0) << "an old state is never taken for a new one";
}

TEST(V2vInputs, HaveTheRangeOfTheRelay) {
  server::Fixture f({.radio = 1.0, .world = watched_room()});
  Watched watched;
  f.service->record_to(watched);
  const auto second = f.make_client(1);
  run_both(f, *second, 10);
  EXPECT_EQ(watched.last.at(kValid), 0.0) << "4 m apart";
}

}  // namespace
}  // namespace sf::server
