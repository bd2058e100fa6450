// Scans from poses on the device have the bytes of the other casters, in the submission of the motion.

#include "raycast/pose_scanner.h"

#include <gtest/gtest.h>

#include <bit>

#include "base/error.h"
#include "base/random.h"
#include "farm/farm.h"
#include "raycast/casters.h"
#include "robots/device/device_fleet.h"
#include "robots/fleet.h"
#include "tests/device.h"
#include "tests/sensors/scenes.h"
#include "world/copies.h"

namespace sf::raycast {
namespace {

constexpr std::int64_t kTick = 100'000'000;

/// Adds a robot with several lasers, whose settings it appends.
void add_robot(world::World& world, const base::Pose& X_WM, const std::vector<sensors::LaserSettings>& lasers,
               std::vector<Scanner>& scanners) {
  const std::uint32_t row = scenes::add_robot(world, X_WM, lasers.front());
  for (std::uint32_t k = 0; k < lasers.size(); ++k) {
    if (k > 0) world.movers[row].sensors.push_back(sensors::laser_sensor(lasers[k]));
    scanners.push_back({lasers[k], row, k});
  }
}

/// Returns four worlds of three robots among boxes.
world::World crowded_worlds(std::vector<Scanner>& scanners) {
  world::World world = scenes::boxes(40, 6.0, 4);
  sensors::LaserSettings front = scenes::laser(91, M_PI, 3.0), round = scenes::laser(64, 2.0 * M_PI, 20.0);
  front.X_MS = {0.1, -0.02, 0.05, 0.3};
  front.range_min = 0.05;
  round.resolution = 3;
  add_robot(world, {0.0, 0.0, 0.0, 0.4}, {front, round}, scanners);
  add_robot(world, {0.8, 0.1, 0.0, 2.0}, {round}, scanners);
  add_robot(world, {-0.7, 0.3, 0.02, -1.0}, {front}, scanners);
  world::copy_movers(world, 4);
  const std::vector<Scanner> of_one = scanners;
  for (std::uint32_t copy = 1; copy < 4; ++copy)
    for (Scanner scanner : of_one) scanner.mover += 3 * copy, scanners.push_back(scanner);
  return world;
}

std::vector<base::Twist> random_commands(std::size_t movers, std::uint32_t tick) {
  std::vector<base::Twist> commands;
  for (std::uint32_t row = 0; row < movers; ++row) {
    const auto u = base::random_uniform({.seed = 9, .a = row, .b = tick / 5}, 0);
    commands.push_back({u[0] - 0.3, 0.0, 3.0 * u[1] - 1.5});
  }
  return commands;
}

/// Compares the cast beams of one scanner with a reading. Returns the number of echoes.
std::size_t compare(const Scanner& scanner, std::span<const double> ranges, const base::ReadingBlock& reading) {
  const std::vector<std::uint32_t> samples = plan_beams(scanner.scan, false).samples;
  EXPECT_EQ(ranges.size(), samples.size());
  std::size_t echoes = 0;
  for (std::size_t k = 0; k < samples.size() && !testing::Test::HasFailure(); ++k) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(ranges[k]), std::bit_cast<std::uint64_t>(reading.values[samples[k]]))
        << "beam " << samples[k] << " of mover " << scanner.mover << ": " << ranges[k] << ", farm "
        << reading.values[samples[k]];
    echoes += ranges[k] < scanner.scan.range_max ? 1 : 0;
  }
  return echoes;
}

TEST(PoseScanner, BytesOfTheFarmWhileRobotsMove) {
  std::vector<Scanner> scanners;
  const world::World world = crowded_worlds(scanners);
  ASSERT_EQ(PoseScanner::refusal(scanners), "");
  ASSERT_EQ(robots::DeviceFleet::refusal(world, kTick), "");
  robots::Fleet host(world);
  farm::Farm farm(world, device(), {.noise = false, .threads = 1, .scene = {.caster = &host_caster}});
  farm.subscribe_all();
  robots::DeviceFleet fleet(world, device());
  PoseScanner scanner(world, scanners, device(), fleet.poses(), fleet.absent());
  fleet.then([&](gpu::Batch& batch) { scanner.record(batch); });
  std::size_t echoes = 0, compared = 0;
  for (std::uint32_t tick = 0; tick < 40 && !HasFailure(); ++tick) {
    if (tick == 20) host.set_absent(4, true), fleet.set_absent(4, true), farm.set_absent(4, true);
    const auto commands = random_commands(world.movers.size(), tick);
    host.move(commands, kTick);
    fleet.set_commands(commands);
    fleet.move(kTick);
    scanner.read();
    for (const base::ReadingBlock& reading : farm.tick((tick + 1) * kTick, host.reports())) {
      const auto own = std::ranges::find_if(
          scanners, [&](const Scanner& s) { return s.mover == reading.mover && s.sensor == reading.sensor; });
      ASSERT_NE(own, scanners.end());
      echoes += compare(*own, scanner.ranges(static_cast<std::size_t>(own - scanners.begin())), reading);
      ++compared;
    }
  }
  EXPECT_GE(compared, 40 * scanners.size() - 40);
  EXPECT_GT(echoes, 10'000u);
}

TEST(PoseScanner, WorldWithoutSurfacesOrScanners) {
  world::World world;
  robots::DeviceFleet fleet(world, device());
  PoseScanner scanner(world, {}, device(), fleet.poses(), fleet.absent());
  fleet.then([&](gpu::Batch& batch) { scanner.record(batch); });
  fleet.move(kTick);
  EXPECT_NO_THROW(scanner.read());
}

TEST(PoseScanner, OneRobotInNothingReadsTheEndOfItsRange) {
  world::World world;
  std::vector<Scanner> scanners;
  add_robot(world, {}, {scenes::laser(5, M_PI, 3.0)}, scanners);
  robots::DeviceFleet fleet(world, device());
  PoseScanner scanner(world, scanners, device(), fleet.poses(), fleet.absent());
  fleet.then([&](gpu::Batch& batch) { scanner.record(batch); });
  fleet.move(kTick);
  scanner.read();
  for (const double range : scanner.ranges(0)) EXPECT_EQ(range, 3.0);
}

TEST(PoseScanner, RefusesWhatTheHostDrawsOrRounds) {
  Scanner scanner{scenes::laser(5)};
  EXPECT_EQ(PoseScanner::refusal({&scanner, 1}), "");
  scanner.single = true;
  EXPECT_NE(PoseScanner::refusal({&scanner, 1}).find("32 bits"), std::string::npos);
  scanner.single = false;
  scanner.scan.noise.angle_sigma = 0.1;
  EXPECT_NE(PoseScanner::refusal({&scanner, 1}).find("angular noise"), std::string::npos);
}

}  // namespace
}  // namespace sf::raycast
