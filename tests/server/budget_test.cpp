// Budgets of `serve`: readings with a low priority are dropped, and their robots are notified.

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/refusal.h"
#include "tests/server/fixture.h"

namespace sf::server {
namespace {

/// The room, with a second laser of a high priority on each robot.
world::World two_lasers() {
  world::World world = room();
  for (world::Mover& mover : world.movers) {
    world::Sensor second = mover.sensors[0];
    second.name = "important";
    second.settings.push_back({.key = "priority", .numbers = {9.0}});
    mover.sensors.push_back(second);
  }
  return world;
}

/// [byte] of a packet: header, number and 91 ranges of two bytes.
double packet_bytes() {
  Fixture f({.world = two_lasers()});
  f.run(10);
  const netio::OutboxCounts packets = f.service->stats().publisher.packets;
  return static_cast<double>(packets.sent_bytes) / static_cast<double>(packets.sent);
}

TEST(Budget, HighPrioritiesHoldWhenTheNetworkIsHalfAsLarge) {
  const double bytes = packet_bytes();
  Fixture enough({.world = two_lasers(), .network_budget = 2.1 * 10.0 * bytes});
  enough.run(40);
  EXPECT_EQ(enough.service->stats().publisher.dropped, 0u);
  EXPECT_EQ(enough.log.read_all(), "");

  Fixture half({.world = two_lasers(), .network_budget = 1.05 * 10.0 * bytes});
  half.run(40);
  const std::uint64_t dropped = half.service->stats().publisher.dropped;
  EXPECT_GE(dropped, 30u);
  EXPECT_EQ(half.client->link().whole(sensors::kLaser, 1), 39u);
  EXPECT_EQ(half.client->link().whole(sensors::kLaser, 0) + dropped, 39u) << "everything else arrived";
  const std::string log = half.log.read_all();
  expect_in("the farm drops readings of laser:0, whose priority is too low for its budget", log);
  EXPECT_EQ(log.find("laser:1"), std::string::npos);
}

/// Boundary: a budget that no reading fits drops all but those that the full bucket paid for.
TEST(Budget, WithoutProcessorTimeReadingsAreDroppedAndStated) {
  Fixture f({.world = two_lasers(), .processor_budget = 1e-12});
  f.run(40);
  const ServiceStats stats = f.service->stats();
  EXPECT_GE(stats.farm.dropped, 60u);
  EXPECT_EQ(stats.farm.dropped + stats.farm.readings, 78u) << "two per tick since the robot is known";
  const std::string log = f.log.read_all();
  for (const char* sensor : {"laser:0", "laser:1"}) expect_in(std::string("drops readings of ") + sensor, log);
  const DroppedReadings& told = f.client->stats().dropped;
  EXPECT_LE(told.processor, stats.farm.dropped);
  EXPECT_GE(told.processor, stats.farm.dropped - 8) << "notices are sent every 0.25 s";
  EXPECT_EQ(told.network, 0u);
}

TEST(Budget, DroppedReadingsAreSummedOverSensorsAndStartsOfTheFarm) {
  LogPipe log;
  RobotClientLog client("r1", 1, log.descriptor(), 0);
  client.note_dropped(0, {sensors::kLaser, 5, 2}, 0);
  client.note_dropped(1, {sensors::kLaser, 1, 0}, 0);
  client.note_dropped(0, {sensors::kLaser, 7, 2}, 1'000'000'000);
  client.note_dropped(0, {sensors::kLaser, 3, 0}, 2'000'000'000);  // started again
  EXPECT_EQ(client.dropped().processor, 11u);
  EXPECT_EQ(client.dropped().network, 2u);
  const std::string lines = log.read_all();
  EXPECT_EQ(std::ranges::count(lines, '\n'), 2) << "one per sensor and ten seconds: " << lines;
}

}  // namespace
}  // namespace sf::server
