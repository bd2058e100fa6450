// A fleet on a device moves as one on the host, to the byte.

#include "robots/device/device_fleet.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/error.h"
#include "base/random.h"
#include "robots/fleet.h"
#include "tests/device.h"
#include "tests/robots/scenes.h"
#include "tests/units.h"
#include "world/copies.h"

namespace sf::robots {
namespace {

using base::Pose;
using base::Report;
using base::Twist;
using world::World;

constexpr std::int64_t kTick = 100'000'000;

/// Returns a random number in [-1, 1) that depends on all arguments.
double random_of(std::uint64_t seed, std::uint32_t row, std::uint32_t tick, unsigned k) {
  return 2.0 * base::random_uniform({.seed = seed, .a = row, .b = tick}, 0)[k] - 1.0;
}

/// Returns a command that changes every ten ticks, sometimes a turn in place or rest.
Twist random_command(std::uint64_t seed, std::uint32_t row, std::uint32_t tick) {
  const std::uint32_t period = tick / 10;
  const double kind = random_of(seed + 1, row, period, 0);
  const Twist v{0.8 * random_of(seed, row, period, 0), 0.5 * random_of(seed, row, period, 1),
                2.0 * random_of(seed + 1, row, period, 1)};
  if (kind < -0.8) return {};
  if (kind < -0.5) return {0.0, 0.0, v.turn};
  if (kind > 0.7) return {v.forward, v.left, 0.0};
  return v;
}

std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

/// Describes the first different number of two states; "" if all bytes agree.
std::string difference(const Report& host, const Report& device) {
  const auto numbers = [](const Report& r) {
    return std::array{r.X_WM.x, r.X_WM.y, r.X_WM.z, r.X_WM.yaw, r.velocity.forward, r.velocity.left, r.velocity.turn};
  };
  const auto a = numbers(host), b = numbers(device);
  for (std::size_t k = 0; k < a.size(); ++k)
    if (bits(a[k]) != bits(b[k])) return fmt::format("number {}: {:.17g}, device {:.17g}", k, a[k], b[k]);
  if (host.contact_mask != device.contact_mask)
    return fmt::format("sectors {:#x}, device {:#x}", host.contact_mask, device.contact_mask);
  return host.mover == device.mover && host.time == device.time ? "" : "mover or time";
}

/// Two fleets of one world.
class Pair {
 public:
  explicit Pair(World world, gpu::Device& on = device())
      : world_(std::move(world)), host_(world_), device_(world_, on) {}

  /// Moves both by one tick. Returns false, with a failure, if they differ.
  bool move(std::span<const Twist> commands, std::int64_t dt = kTick) {
    host_.move(commands, dt);
    device_.set_commands(commands);
    device_.move(dt);
    ++ticks_;
    return agree();
  }
  void set_absent(std::uint32_t row, bool gone) { host_.set_absent(row, gone), device_.set_absent(row, gone); }

  void restart(std::uint32_t row) { host_.restart(row), device_.set_state(host_.reports()[row]); }

  const Fleet& host() const { return host_; }
  std::size_t touching() const { return touching_; }  ///< rows and ticks with contacts

 private:
  bool agree() {
    const auto expected = host_.reports(), found = device_.reports();
    for (std::size_t row = 0; row < expected.size(); ++row) {
      touching_ += host_.contacts()[row];
      const std::string why = difference(expected[row], found[row]);
      EXPECT_EQ(why, "") << "row " << row << ", tick " << ticks_;
      EXPECT_EQ(host_.contacts()[row], device_.contacts()[row]) << "row " << row << ", tick " << ticks_;
      if (testing::Test::HasFailure()) return false;
    }
    return true;
  }

  World world_;
  Fleet host_;
  DeviceFleet device_;
  std::uint32_t ticks_ = 0;
  std::size_t touching_ = 0;
};

/// Moves both fleets with random commands. Returns the number of rows and ticks with contacts.
std::size_t drive(Pair& fleets, std::uint32_t ticks, std::uint64_t seed = 1) {
  std::vector<Twist> commands(fleets.host().reports().size());
  for (std::uint32_t tick = 0; tick < ticks; ++tick) {
    for (std::uint32_t row = 0; row < commands.size(); ++row) commands[row] = random_command(seed, row, tick);
    if (!fleets.move(commands)) break;
  }
  return fleets.touching();
}

std::size_t drive(const World& world, std::uint32_t ticks, std::uint64_t seed = 1) {
  Pair fleets(world);
  return drive(fleets, ticks, seed);
}

TEST(DeviceFleet, WorldWithoutMovers) { EXPECT_EQ(drive(scenes::boxed_world(4, 4), 2), 0u); }

TEST(DeviceFleet, RobotWithoutWalls) {  // an empty tree
  World world = scenes::empty_world();
  scenes::add_create(world, {});
  EXPECT_EQ(drive(world, 20), 0u);
}

TEST(DeviceFleet, RobotWithoutABodyPassesThroughWalls) {
  World world = scenes::boxed_world(1, 1);
  scenes::add_mover(world, {0.5, 0.5, 0, 0}, {});
  scenes::add_square(world, {0.5, 0.5, 0, 0});
  drive(world, 40);
}

// A path of length 0 by rounding has one step, also next to obstacles.
TEST(DeviceFleet, SmallestSpeedAtAWall) {
  World world = scenes::boxed_world(0.5, 0.5);
  scenes::add_square(world, {0.25, 0.25, 0, 0.1});
  Pair fleets(world);
  for (const Twist& v : {Twist{5e-324, 0, 0}, Twist{1, 0, 0}, Twist{5e-324, 0, 0}, Twist{0, 0, -5e-324}})
    fleets.move({&v, 1});
}

TEST(DeviceFleet, CommandsThatAreNotFinite) {
  World world = scenes::empty_world();
  scenes::add_create(world, {});
  Pair fleets(world);
  const double inf = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  for (const Twist& v : {Twist{nan, 0, 0}, Twist{0.1, 0, inf}, Twist{-inf, nan, 0.2}, Twist{1e300, 1e300, -1e300},
                         Twist{-0.0, -0.0, -0.0}, Twist{5e-324, 0, -5e-324}})
    fleets.move({&v, 1});
}

// Speeds, turns, accelerations, slip and drivers of all drives, in one world each.
TEST(DeviceFleet, DrivesAndTheirLimits) {
  World world = scenes::empty_world();
  for (const world::Drive drive :
       {world::Drive::differential, world::Drive::omni, world::Drive::car, world::Drive::skid})
    for (int k = 0; k < 6; ++k) {
      const double row = static_cast<double>(world.movers.size());
      world::Mover& mover = scenes::add_square(world, {5.0 * row, 0, 0, row});
      mover.drive = drive;
      mover.max_turn = k == 5 ? 20.0 : 1.5;
      mover.wheelbase = 0.3;
      if (k % 2 == 1) mover.max_acceleration = 0.7;
      if (k >= 2) mover.max_turn_acceleration = 1.1;
      if (k == 4) mover.actuator_model = world::ActuatorModel::player_create;
      world.variations.push_back({.slip = 0.03 * k, .acceleration = 1.0 - 0.1 * k});
    }
  EXPECT_EQ(drive(world, 200), 0u);
}

// Speeds that round to zero from below, the sharpest turns of both signs, and radii beyond the limit.
TEST(DeviceFleet, DriverOfTheCreate) {
  World world = scenes::empty_world();
  world::Mover& mover = scenes::add_create(world, {});
  mover.actuator_model = world::ActuatorModel::player_create;
  mover.track = 0.26;
  Pair fleets(world);
  for (const Twist& v :
       {Twist{-3e-4, 0, 0}, Twist{-5e-4, 0, 0}, Twist{0, 0, -1e-3}, Twist{1e-3, 0, 5}, Twist{-1e-3, 0, 5},
        Twist{1e-3, 0, -5}, Twist{0.2, 0, 1e-9}, Twist{-0.2, 0, 1e-300}, Twist{0.7, 0, 0.3}, Twist{2.5e-3, 0, 0.0}})
    fleets.move({&v, 1});
}

// Yaws far beyond a turn, at which the remainder changes sign, and coordinates of 100 km.
TEST(DeviceFleet, FarYawsAndPlaces) {
  World world = scenes::empty_world();
  for (const double yaw : {M_PI, -M_PI, 2 * M_PI, -2 * M_PI, 3 * M_PI, 5 * M_PI, 7.5 * M_PI, 99'000.0, -99'000.0, -0.0})
    scenes::add_square(world, {1e5 + 2.0 * static_cast<double>(world.movers.size()), -1e5, 0, yaw});
  drive(world, 20);
}

TEST(DeviceFleet, WorldsOfOneRobotAmongWalls) {
  World world = scenes::empty_world();
  scenes::add_bitmap(world, scenes::cave(20, 20, 3), 0.2);
  scenes::add_wall(world, {1.9, 1.9}, {2.3, 2.2}, 0.05, 1.0);
  scenes::add_wall(world, {1.5, 1.9}, {1.6, 2.2}, 0.1, 1.0);  // above all robots
  scenes::add_create(world, {2.0, 1.7, 0, 0.3});
  world::copy_movers(world, 16);
  for (std::uint32_t row = 0; row < 16; ++row) world.variations.push_back({.slip = 0.01 * row});
  EXPECT_GT(drive(world, 200), 500u);
}

World crowd(std::uint32_t copies) {
  World world = scenes::boxed_world(2.6, 2.6);
  for (int i = 0; i < 12; ++i) {
    const Pose X{0.4 + 0.6 * (i % 4), 0.4 + 0.7 * (i / 4), 0, 0.7 * i};
    world::Mover& mover = i % 4 == 0   ? scenes::add_create(world, X)
                          : i % 4 == 1 ? scenes::add_mover(world, X, scenes::rectangle({0.03, 0}, 0.3, 0.15))
                          : i % 4 == 2 ? scenes::add_mover(world, X, {{0.2, 0}, {-0.1, 0.12}, {0, 0}, {-0.1, -0.12}})
                                       : scenes::add_square(world, X);
    mover.is_tag = i == 5;
    if (i == 6) mover.drive = world::Drive::car, mover.wheelbase = 0.2;
    if (i == 7) mover.drive = world::Drive::omni;
    if (i == 8) mover.X_WM.z = 0.05;    // overlaps the others' heights in part
    if (i == 9) mover.X_WM.z = 0.2;     // passes above the others
    if (i == 10) mover.X_WM.x -= 0.25;  // starts in another robot
  }
  world::copy_movers(world, copies);
  return world;
}

TEST(DeviceFleet, CrowdInOneWorld) { EXPECT_GT(drive(crowd(1), 200), 300u); }

TEST(DeviceFleet, CrowdsInManyWorlds) { EXPECT_GT(drive(crowd(5), 60, 7), 300u); }

// Outlines that certainly overlap are left only by moving apart.
TEST(DeviceFleet, RobotsThatStartInEachOther) {
  World world = scenes::empty_world();
  for (int i = 0; i < 5; ++i) scenes::add_create(world, {0.04 * i, 0.03 * (i % 2), 0, 1.3 * i});
  scenes::add_square(world, {0.05, 0.02, 0, 0.2});
  EXPECT_GT(drive(world, 100), 100u);
}

// No edges meet, and the origins are far apart.
TEST(DeviceFleet, RobotInsideALongRobot) {
  World world = scenes::empty_world();
  scenes::add_mover(world, {0, 0, 0, 0}, scenes::rectangle({}, 8.0, 1.2));
  scenes::add_mover(world, {2.5, 0.1, 0, 0.4}, scenes::rectangle({}, 0.2, 0.2));
  EXPECT_GT(drive(world, 100), 5u);
}

// Cells of the grid of movers, and walls in several leaves of the tree.
TEST(DeviceFleet, CrowdInACave) {
  World world = scenes::empty_world();
  scenes::add_bitmap(world, scenes::cave(60, 60, 3), 0.2);
  for (int i = 0; i < 22 * 22; ++i) {
    const Pose X{0.6 + 0.5 * (i % 22), 0.6 + 0.5 * (i / 22), 0, 0.1 * i};
    i % 3 == 0 ? scenes::add_create(world, X) : scenes::add_square(world, X);  // some start in walls
  }
  EXPECT_GT(drive(world, 30), 1'000u);
}

// More movers near a path than a kernel lists.
TEST(DeviceFleet, PackOfSmallRobots) {
  World world = scenes::boxed_world(0.7, 0.7);
  for (int i = 0; i < 49; ++i)
    scenes::add_mover(world, {0.05 + 0.1 * (i % 7), 0.05 + 0.1 * (i / 7), 0, 0.3 * i},
                      scenes::rectangle({}, 0.06, 0.05));
  EXPECT_GT(drive(world, 60), 1'000u);
}

TEST(DeviceFleet, MoversThatLeaveAndReturn) {
  Pair fleets(crowd(2));
  for (std::uint32_t k = 0; k < 6; ++k) {
    fleets.set_absent(2 * k, true);
    drive(fleets, 5, k);
    if (k >= 2) fleets.set_absent(2 * (k - 2), false);
  }
}

TEST(DeviceFleet, MoversThatRestartAmongOthers) {
  Pair fleets(crowd(2));
  for (std::uint32_t k = 0; k < 6; ++k) {
    drive(fleets, 8, k);
    for (std::uint32_t row = 0; row < 12; ++row) fleets.restart(row);  // one of the two worlds
  }
  EXPECT_GT(fleets.touching(), 100u);
}

// Tables are copied in both directions, and only in part. The validation layer has no objection, where it is installed.
TEST(DeviceFleet, DeviceWithItsOwnMemory) {
  const char* const set = std::getenv("SENSORFARM_STAGING");
  const std::string before = set != nullptr ? set : "0";
  setenv("SENSORFARM_STAGING", "1", 1);
  setenv("SENSORFARM_VALIDATE", "1", 1);
  gpu::Device staged;
  unsetenv("SENSORFARM_VALIDATE");
  setenv("SENSORFARM_STAGING", before.c_str(), 1);
  ASSERT_FALSE(staged.unified());
  const bool validated = staged.validation_messages().find("not installed") == std::string::npos;
  Pair fleets(crowd(2), staged);
  for (std::uint32_t k = 0; k < 4; ++k) {
    drive(fleets, 5, k);
    fleets.set_absent(3 * k, true);
    fleets.restart(5 + k);
  }
  EXPECT_GT(fleets.touching(), 50u);
  EXPECT_EQ(validated ? staged.validation_messages() : "", "");
}

// Far more edges than loops of lavapipe before Mesa 25.0 may visit. A result would be wrong without an error.
TEST(DeviceFleet, LoopsThatTheDeviceWouldEndEarly) {
  World world = scenes::empty_world();
  std::vector<glm::dvec2> corners;
  for (int i = 0; i < 2'000; ++i) corners.push_back(0.2 * base::direction(M_PI * i / 1'000));
  for (const double x : {0.0, 0.1}) scenes::add_mover(world, {x, 0, 0, 0}, corners);
  DeviceFleet fleet(world, device());
  fleet.set_commands(std::vector<Twist>{{0.5, 0, 0}, {0, 0, 0}});
  fleet.move(kTick);
  if (device().info().software)
    EXPECT_THROW(fleet.reports(), base::DeviceError);
  else
    EXPECT_EQ(fleet.reports().size(), 2u);
}

TEST(DeviceFleet, RefusesWhatItDoesNotMove) {
  World world = scenes::empty_world();
  scenes::add_square(world, {});
  EXPECT_EQ(DeviceFleet::refusal(world, kTick), "");
  const auto refused = [&](auto&& change) {
    World changed = world;
    change(changed);
    return DeviceFleet::refusal(changed, kTick);
  };
  EXPECT_NE(refused([](World& w) { w.ramps.emplace_back(); }).find("roads above the floor"), std::string::npos);
  EXPECT_NE(refused([](World& w) { w.movers[0].dynamics.name = "car"; }).find("dynamics"), std::string::npos);
  EXPECT_NE(refused([](World& w) { w.movers[0].max_forward = 1e3; }).find("substeps"), std::string::npos);
  EXPECT_NE(refused([](World& w) { w.movers[0].max_forward = HUGE_VAL; }).find("substeps"), std::string::npos);
  EXPECT_NE(refused([](World& w) { w.movers[0].max_turn = HUGE_VAL; }).find("may turn"), std::string::npos);
  EXPECT_NE(refused([](World& w) { w.movers[0].X_WM.yaw = 1e6; }).find("may turn"), std::string::npos);
}

}  // namespace
}  // namespace sf::robots
