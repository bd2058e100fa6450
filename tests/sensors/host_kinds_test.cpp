// What every kind that needs no device does: the same bytes for any threads, no allocation once warm.

#include <gtest/gtest.h>

#include "sensors/bumper.h"
#include "sensors/encoder.h"
#include "sensors/gps.h"
#include "sensors/gyro.h"
#include "sensors/irreceiver.h"
#include "tests/sensors/host_trial.h"

namespace sf::trial {
namespace {

/// Robots with one of each, a roof, walls, a hole and a dock.
world::World everything(int robots) {
  world::World world;
  for (int i = 0; i < robots; ++i) {
    const auto m = scenes::add_carrier(world, {0.1 * i, 0.05 * i, 0, 0.3 * i}, fitted("bumper"));
    auto& sensors = world.movers[m].sensors;
    sensors.push_back(fitted("cliff"));
    sensors.push_back(fitted("encoder", {setting("slip", {0.01}), setting("per_count", {1e-6})}));
    sensors.push_back(fitted("gyro", {setting("noise", {0.1}), setting("bias", {0.1})}));
    sensors.push_back(fitted("gps", {setting("noise", {1}), setting("rate", {10})}));
    sensors.push_back(fitted("irreceiver"));
  }
  add_solid(world, square({2, 1}, 1.5), 0.5, 0.6);
  add_solid(world, square({4, 1}, 0.2), 0.0, 2.0);
  world.drops.push_back({square({1, 0.5}, 0.7), 0});
  world.emitters.push_back({world::Emitter::Kind::dock, world::kNone, {3, 1, 0, 0}, 2.0, 0.7, 0.5});
  return world;
}

std::vector<base::Report> moved(const world::World& world, int tick) {
  std::vector<base::Report> states = states_of(world);
  for (base::Report& s : states) {
    s.X_WM.x += 0.02 * (tick % 8);
    s.X_WM.yaw += 0.1 * (tick % 8);
    s.velocity.turn = 0.1 * tick;
    s.touched = static_cast<std::uint32_t>(tick) << s.mover % 8;
  }
  return states;
}

std::uint64_t hash_of(const world::World& world, const farm::FarmOptions& options) {
  farm::Farm farm(world, device(), options);
  farm.hear_all();
  for (int tick = 0; tick < 30; ++tick) farm.tick(tick * 100'000'000ll, moved(world, tick));
  return farm.hash();
}

TEST(HostKinds, TheSameBytesForAnyThreads) {
  const world::World world = everything(200);
  const std::uint64_t one = hash_of(world, {.seed = 1, .threads = 1});
  for (const unsigned threads : {2u, 3u}) EXPECT_EQ(hash_of(world, {.seed = 1, .threads = threads}), one);
  EXPECT_NE(hash_of(world, {.seed = 2}), one);
}

/// A robot's readings do not depend on who else is there.
TEST(HostKinds, OthersChangeNothing) {
  const world::World few = everything(3), many = everything(50);
  farm::Farm a(few, device(), {.seed = 1}), b(many, device(), {.seed = 1});
  a.hear_all();
  b.hear_all();
  for (int tick = 0; tick < 5; ++tick) {
    std::vector<std::vector<double>> first, second;
    for (const auto& r : a.tick(tick * 100'000'000ll, moved(few, tick))) first.push_back(values_of(r));
    for (const auto& r : b.tick(tick * 100'000'000ll, moved(many, tick)))
      if (r.mover < 3) second.push_back(values_of(r));
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      for (std::size_t k = 0; k < first[i].size(); ++k)
        EXPECT_TRUE(first[i][k] == second[i][k] || (std::isnan(first[i][k]) && std::isnan(second[i][k])));
  }
}

TEST(HostKinds, AreSensedByHandAnywhere) {
  const world::World world = everything(2);
  farm::Farm farm(world, device());
  const auto sense = [&](std::uint8_t kind) { return farm.sense(1, kind, 0, {100, 100, 0, 1}); };
  EXPECT_EQ(sense(sensors::kGps).values[3], 8.0);
  EXPECT_EQ(sense(sensors::kEncoder).values[2], 0.0);
  EXPECT_EQ(sense(sensors::kBumper).values[0], 0.0);
  EXPECT_EQ(sense(sensors::kIrReceiver).values[1], 255.0);
  EXPECT_EQ(sense(sensors::kGps).X_WS.x, 100.0);
}

/// Phase, latency and names are every sensor's.
TEST(HostKinds, LatencyHoldsReadingsBack) {
  const world::World world = carriers(fitted("gyro", {setting("latency", {0.15})}));
  farm::Farm farm(world, device());
  farm.hear_all();
  for (int tick = 0; tick < 10; ++tick) {
    const auto readings = farm.tick(tick * 100'000'000ll, {});
    ASSERT_EQ(readings.size(), tick < 2 ? 0u : 1u) << tick;
    EXPECT_TRUE(tick < 2 || readings[0].time == (tick - 2) * 100'000'000ll);
  }
}

}  // namespace
}  // namespace sf::trial
