// Scans from poses on the device have the bytes of the other casters, in the submission of the motion.

#include "raycast/pose_scanner.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>

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

constexpr std::uint64_t kSeed = 0x987654321ull;
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
world::World crowded_worlds(std::vector<Scanner>& scanners, const ScanNoise& noise = {}) {
  world::World world = scenes::boxes(12, 6.0, 4);
  sensors::LaserSettings front = scenes::laser(91, M_PI, 3.0), round = scenes::laser(64, 2.0 * M_PI, 20.0);
  front.X_MS = {0.1, -0.02, 0.05, 0.3};
  front.range_min = 0.3;
  round.resolution = 3;
  front.noise = round.noise = noise;
  round.X_MS.z = 0.07;
  add_robot(world, {0.0, 0.0, 0.0, 0.4}, {front, round}, scanners);
  add_robot(world, {0.8, 0.1, 0.0, 2.0}, {round}, scanners);
  add_robot(world, {-0.7, 0.3, 0.02, -1.0}, {front}, scanners);
  world.walls.push_back({.a = {-2, -1}, .b = {2, -0.8}, .z_max = 0.045});  // below all lasers at 0.05 m
  world.walls.push_back({.a = {-2, 1.1}, .b = {2, 0.9}, .z_min = 0.06, .z_max = 1.0, .stops_robots = false});
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

/// A fleet and its scans on the device, and the same on the host.
class Twin {
 public:
  Twin(const world::World& world, std::vector<Scanner> scanners, bool noise = false, gpu::Device& on = device())
      : scanners_(std::move(scanners)),
        host_(world),
        farm_(world, on, {.seed = kSeed, .noise = noise, .threads = 1, .scene = {.caster = &host_caster}}),
        fleet_(world, on),
        scanner_(world, scanners_, farm_.episodes(), on, fleet_.poses(), fleet_.absent()) {
    farm_.subscribe_all();
    fleet_.then([this](gpu::Batch& batch) { scanner_.record(batch); },
                [this](gpu::Batch& batch) { scanner_.prepare(batch); });
  }

  /// Moves and scans both for one tick, and compares all readings.
  void tick(std::span<const base::Twist> commands) {
    host_.move(commands, kTick);
    fleet_.set_commands(commands);
    fleet_.move(kTick);
    scanner_.read();
    for (const base::ReadingBlock& reading : farm_.tick(++ticks_ * kTick, host_.reports())) {
      const auto own = std::ranges::find_if(
          scanners_, [&](const Scanner& s) { return s.mover == reading.mover && s.sensor == reading.sensor; });
      ASSERT_NE(own, scanners_.end());
      echoes_ += compare(*own, scanner_.ranges(static_cast<std::size_t>(own - scanners_.begin())), reading);
      ++readings_;
    }
  }
  void remove(std::uint32_t mover) {
    host_.set_absent(mover, true), fleet_.set_absent(mover, true), farm_.set_absent(mover, true);
  }
  void restart(std::uint32_t copy, std::uint64_t seed) {
    const auto movers = static_cast<std::uint32_t>(host_.reports().size() / 4);
    for (std::uint32_t row = copy * movers; row < (copy + 1) * movers; ++row) {
      host_.restart(row);
      fleet_.set_state(host_.reports()[row]);
    }
    const farm::Farm::Restart restart{copy, seed};
    farm_.restart({&restart, 1}, host_.reports().subspan(copy * movers, movers));
    scanner_.restart(copy);
  }
  std::size_t echoes() const { return echoes_; }
  std::size_t readings() const { return readings_; }

 private:
  std::vector<Scanner> scanners_;
  robots::Fleet host_;
  farm::Farm farm_;
  robots::DeviceFleet fleet_;
  PoseScanner scanner_;
  std::int64_t ticks_ = 0;
  std::size_t echoes_ = 0, readings_ = 0;
};

TEST(PoseScanner, BytesOfTheFarmWhileRobotsMove) {
  std::vector<Scanner> scanners;
  const world::World world = crowded_worlds(scanners);
  ASSERT_EQ(PoseScanner::refusal(scanners), "");
  ASSERT_EQ(robots::DeviceFleet::refusal(world, kTick), "");
  Twin twin(world, scanners);
  for (std::uint32_t tick = 0; tick < 40 && !HasFailure(); ++tick) {
    if (tick == 20) twin.remove(4);
    twin.tick(random_commands(world.movers.size(), tick));
  }
  EXPECT_GE(twin.readings(), 40 * scanners.size() - 40);
  EXPECT_GT(twin.echoes(), 10'000u);
}

// Noise in proportion to the range, at both ends of it, and less in one of the worlds; one world restarts. The device
// has memory of its own.
TEST(PoseScanner, NoiseOfTheFarm) {
  std::vector<Scanner> scanners;
  world::World world = crowded_worlds(scanners, {.range_sigma = 0.4, .range_proportional = 0.3});
  world.variations.resize(5);
  world.variations[3].noise = 0.25;
  setenv("SENSORFARM_STAGING", "1", 1);
  setenv("SENSORFARM_VALIDATE", "1", 1);
  gpu::Device own;
  unsetenv("SENSORFARM_VALIDATE");
  unsetenv("SENSORFARM_STAGING");
  const bool validated = own.validation_messages().find("not installed") == std::string::npos;
  Twin twin(world, scanners, true, own);
  for (std::uint32_t tick = 0; tick < 12 && !HasFailure(); ++tick) {
    if (tick == 6) twin.restart(2, 77);
    twin.tick(random_commands(world.movers.size(), tick));
  }
  EXPECT_GT(twin.echoes(), 2'000u);
  EXPECT_EQ(validated ? own.validation_messages() : "", "");
}

// Robots above, below and at the height of a laser at 0.1 m.
TEST(PoseScanner, RobotsOfOtherHeights) {
  world::World world;
  std::vector<Scanner> scanners;
  const sensors::LaserSettings round = scenes::laser(60, 2.0 * M_PI, 3.0);
  for (const double z : {0.0, 0.02, 0.1, 0.11, -0.2, -0.25}) {
    const double bearing = static_cast<double>(world.movers.size());
    add_robot(world, {std::cos(bearing), std::sin(bearing), z, bearing}, {round}, scanners);
    for (world::Segment& edge : world.movers.back().body) edge.z_min = 0.0, edge.z_max = 0.08 + 0.25 * (z < -0.1);
  }
  Twin twin(world, scanners);
  twin.tick(std::vector<base::Twist>(world.movers.size()));
  EXPECT_EQ(twin.readings(), scanners.size());
  EXPECT_GT(twin.echoes(), 10u);
}

// Beams that enter a surface within the contact distance read 0 or range_min, those that leave it pass.
TEST(PoseScanner, SensorsOnAndNextToAWall) {
  world::World world;
  world.models.push_back({.name = "walls", .type = "model"});
  std::vector<Scanner> scanners;
  for (const double x : {0.0, 1e-10, -1e-10, 5e-10, -2e-9, 2e-9, 1e-3}) {
    const double y = 3.0 * static_cast<double>(world.movers.size());
    world.walls.push_back({.a = {0, y - 1}, .b = {0, y + 1}, .z_max = 1.0, .stops_robots = false});
    sensors::LaserSettings laser = scenes::laser(36, 2.0 * M_PI, 3.0);
    laser.X_MS = {};
    add_robot(world, {x, y, 0, 0}, {laser}, scanners);
  }
  Twin twin(world, scanners);
  twin.tick(std::vector<base::Twist>(world.movers.size()));
  EXPECT_EQ(twin.readings(), scanners.size());
  EXPECT_GT(twin.echoes(), 50u);
}

TEST(PoseScanner, WorldWithoutSurfacesOrScanners) {
  world::World world;
  robots::DeviceFleet fleet(world, device());
  PoseScanner scanner(world, {}, Episodes(), device(), fleet.poses(), fleet.absent());
  fleet.then([&](gpu::Batch& batch) { scanner.record(batch); });
  fleet.move(kTick);
  EXPECT_NO_THROW(scanner.read());
}

TEST(PoseScanner, OneRobotInNothingReadsTheEndOfItsRange) {
  world::World world;
  std::vector<Scanner> scanners;
  add_robot(world, {}, {scenes::laser(5, M_PI, 3.0)}, scanners);
  robots::DeviceFleet fleet(world, device());
  PoseScanner scanner(world, scanners, Episodes(), device(), fleet.poses(), fleet.absent());
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
