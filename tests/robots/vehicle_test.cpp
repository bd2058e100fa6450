// Cars in six degrees of freedom: closed forms of pitch, roll, coasting and yaw rate, energy, convergence, slopes, and
// as robots of a fleet.

#include "robots/vehicle.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>

#include "base/elementary.h"
#include "base/error.h"
#include "robots/fleet.h"
#include "tests/refusal.h"
#include "tests/robots/scenes.h"
#include "tests/robots/vehicles.h"

namespace sf::robots {
namespace {

TEST(Vehicle, StandsWhereItsSpringsBearItsWeight) {
  for (const auto& [preset, wheelbase, track] : kPresets) {
    const Vehicle vehicle(vehicle_preset(preset, wheelbase, track));
    VehicleBody body = vehicle.body_at({.X_WM = {1.0, 2.0, 0.01, 0.5}});
    for (int k = 0; k < 10'000; ++k) vehicle.step(body, {.brake = 10.0}, kVehicleStep, kFloor);
    const base::Report at = vehicle.report_of(body);
    EXPECT_NEAR(at.X_WM.z, 0.0, 1e-7) << preset;
    EXPECT_NEAR(at.tilt.pitch, 0.0, 1e-7) << preset;
    double weight = 0.0;
    for (std::size_t k = 0; k < kWheels; ++k) weight += vehicle.load(body, k, kFloor);
    EXPECT_NEAR(weight / (vehicle.model().car.mass * kGravity), 1.0, 1e-6) << preset;
  }
}

TEST(Vehicle, PitchesUnderBrakingByTheClosedForm) {
  const VehicleModel m = family_without_resistance();
  const double a = 2.0, r = m.car.wheel_radius, height = m.car.height;
  Drive drive(m, 20.0, {.max_acceleration = a});
  const double before = drive.go({}, 3.0).velocity.forward;
  const base::Report at = drive.go({}, 1.0);
  EXPECT_NEAR(before - at.velocity.forward, a, 0.01);
  const double moment = m.car.mass * a * height + 4.0 * m.car.wheel_inertia * a / r;
  const double stiffness = m.spring * kWheelbase * kWheelbase - m.car.mass * kGravity * height;
  EXPECT_NEAR(at.tilt.pitch / (moment / stiffness), 1.0, 0.01) << "the nose dives";
}

TEST(Vehicle, RollsInASteadyTurnByTheClosedForm) {
  const VehicleModel m = family_without_resistance();
  Drive drive(m, 15.0);
  const base::Report at = drive.go({15.0, 0.0, 0.15}, 10.0);
  const double lateral = 15.0 * at.velocity.turn;
  ASSERT_GT(lateral, 1.0);
  const double stiffness = m.spring * kTrack * kTrack - m.car.mass * kGravity * m.car.height;
  EXPECT_NEAR(at.tilt.roll / (m.car.mass * lateral * m.car.height / stiffness), 1.0, 0.02) << "the left side rises";
}

TEST(Vehicle, CoastsDownByTheClosedForm) {
  const VehicleModel m = family_model();
  const Vehicle vehicle(m);
  VehicleBody body = vehicle.body_at({.X_WM = {}, .velocity = {30.0}});
  const double drag = m.car.drag, rolling = m.car.rolling * m.car.mass * kGravity;
  const double inertia = m.car.mass + 4.0 * m.car.wheel_inertia / (m.car.wheel_radius * m.car.wheel_radius);
  for (int k = 1; k <= 40'000; ++k) {
    vehicle.step(body, {}, kVehicleStep, kFloor);
    const double expected = std::sqrt(rolling / drag) * std::tan(std::atan(30.0 * std::sqrt(drag / rolling)) -
                                                                 1e-3 * k * std::sqrt(drag * rolling) / inertia);
    if (k % 10'000 == 0) {
      EXPECT_NEAR(vehicle.report_of(body).velocity.forward, expected, 0.01) << k;
    }
  }
}

TEST(Vehicle, TurnsAsTheSingleTrackModelAtLowLateralAcceleration) {
  const VehicleModel m = family_without_resistance();
  for (const double speed : {5.0, 15.0, 30.0}) {
    const double turn = 0.3 / speed, steer = std::atan(kWheelbase * turn / speed);
    Drive drive(m, speed);
    const double expected = speed * steer / (kWheelbase + m.car.understeer() * speed * speed);
    EXPECT_NEAR(drive.go({speed, 0.0, turn}, 8.0).velocity.turn / expected, 1.0, 0.02) << speed;
  }
}

TEST(Vehicle, EnergyNeverGrowsWithTheDriveOff) {
  const world::Terrain hills =
      terrain_of([](double x, double y) { return 0.5 * std::sin(0.4 * x) + 0.2 * std::cos(0.7 * y); });
  EXPECT_TRUE(rc::check([&] {
    const auto within = [](double most) { return most * 1e-3 * *rc::gen::inRange(-1'000, 1'001); };
    const auto& [preset, wheelbase, track] = *rc::gen::elementOf(std::vector(std::begin(kPresets), std::end(kPresets)));
    const Vehicle vehicle(vehicle_preset(preset, wheelbase, track));
    const double size = wheelbase / kWheelbase, kerb = 0.45 * vehicle.model().car.wheel_radius;
    const world::Ramp road{
        .a = {-9.0 * size, 0.0}, .b = {0.0, 0.0}, .z_a = kerb, .z_b = kerb, .half_width = 4.0 * size};
    const world::Ground grounds[] = {world::Ground({}), world::Ground({}, {&hills, 1}), world::Ground({&road, 1})};
    const int kind = *rc::gen::inRange(0, 3);
    const world::Ground& ground = grounds[kind];
    // Bodies meet kerbs as steps: stay upright there. On hills, fall from above: edges change depths in the ground.
    const double wild = kind == 2 ? 0.1 : 1.0, reach = kind == 2 ? 6.0 * size : 20.0, above = kind == 1 ? 0.8 : 0.3;
    VehicleBody body = vehicle.body_at(
        {.X_WM = {within(reach), within(reach), 0.0, within(3.0)},
         .velocity = {within((kind == 2 ? 3.0 : 15.0) * std::sqrt(size)), within(3.0 * wild), within(1.0)},
         .tilt = {wild * within(0.3), wild * within(0.3)}});
    body.p.z += ground.height({body.p.x, body.p.y}, 10.0) + size * (above + within(0.3)) * wild;
    body.v.z = wild * within(2.0), body.w += wild * glm::dvec3{within(0.5), within(0.5), 0.0};
    for (double& spin : body.spin) spin *= 1.0 + within(1.0);
    const VehicleControls off{.brake = std::abs(within(1'000.0 * size * size)), .steer = within(0.4)};
    double energy = vehicle.energy(body, ground);
    for (int k = 0; k < 500; ++k) {
      vehicle.step(body, off, kVehicleStep, ground);
      const double now = vehicle.energy(body, ground);
      // Within a step, springs may go on into an edge of the terrain, where slopes differ by up to 0.2, or of a kerb.
      const double way = ground.is_flat() ? 0.0 : kVehicleStep * glm::length(body.v);
      double edge = kBumpStiffness * vehicle.model().spring * way * way;
      for (std::size_t wheel = 0; wheel < kWheels; ++wheel)
        edge += (kind == 2 ? 2.0 : 0.2) * way * vehicle.load(body, wheel, ground);
      RC_ASSERT(now <= energy + 1e-9 * std::abs(energy) + 1e-9 + edge);
      energy = now;
    }
  }));
}

TEST(Vehicle, ErrorsFallWithTheStep) {
  const Vehicle vehicle(family_model());
  const auto end = [&](int parts) {
    VehicleBody body = vehicle.body_at({.X_WM = {0.0, 0.0, 0.02}, .velocity = {15.0}});
    for (int k = 0; k < 2'000 * parts; ++k)
      vehicle.step(body, {.drive = 300.0, .steer = 0.05}, kVehicleStep / parts, kFloor);
    return body.p;
  };
  const glm::dvec3 fine = end(8);
  const double whole = glm::length(end(1) - fine), half = glm::length(end(2) - fine);
  EXPECT_LT(whole, 0.02);
  EXPECT_NEAR(half / whole, 3.0 / 7.0, 0.08) << "of order one: (1/2 - 1/8) of (1 - 1/8)";
}

TEST(Vehicle, StandsOnASlopeWithoutCreeping) {
  const world::Terrain slope = terrain_of([](double x, double) { return 0.3 * x; });
  const world::Ground ground({}, {&slope, 1});
  for (const double yaw : {0.0, 0.5 * M_PI, 2.0}) {
    Drive drive(family_model(), 0.0, {}, ground);
    drive.report.X_WM = {0.0, 0.0, 0.0, yaw};
    drive.report.tilt = ground.tilt(drive.report.X_WM, kWheelbase, kTrack);
    const base::Pose early = drive.go({}, 10.0).X_WM, late = drive.go({}, 30.0).X_WM;
    EXPECT_LT(std::hypot(early.x, early.y), 0.01) << yaw;
    EXPECT_LT(std::hypot(late.x - early.x, late.y - early.y), 1e-8) << yaw;
  }
}

TEST(Vehicle, ThePioneerTurnsAboutAsCommanded) {
  Drive drive(vehicle_preset("pioneer", 0.268, 0.394), 0.0, {.max_acceleration = 1.5, .max_turn_acceleration = 10.0});
  const base::Report at = drive.go({0.5, 0.0, 0.5}, 5.0);
  EXPECT_NEAR(at.velocity.forward, 0.5, 0.03);
  EXPECT_NEAR(at.velocity.turn, 0.5, 0.1);
}

/// Ways [m] within some seconds, and the turn [rad].
struct Ways {
  double left = 0.0, right = 0.0, car = 0.0, turn = 0.0;
};
Ways ways_of(Drive& drive, const base::Twist& command, double seconds) {
  Ways ways;
  for (double t = 0.0; t < seconds - 1e-9; t += 0.1) {
    const base::Pose before = drive.report.X_WM;
    const base::Report& at = drive.go(command, 0.1);
    ways.left += 0.1 * at.wheels.left, ways.right += 0.1 * at.wheels.right;
    ways.car += 0.1 * at.velocity.forward, ways.turn += base::wrap_angle(at.X_WM.yaw - before.yaw);
  }
  return ways;
}
VehicleModel family_on_ice() {
  VehicleModel model = family_model();
  model.car.friction.c1 *= 0.1, model.car.friction.c3 *= 0.1;
  return model;
}

/// Straight ahead and in a turn, of steered wheels and of others, with the slip of the drive.
TEST(Vehicle, WheelsRollWithTheCar) {
  for (const double share : {1.0, 0.0, 0.5})
    for (const double turn : {0.0, 0.5}) {
      VehicleModel model = family_model();
      model.drive_share = share;
      Drive drive(model, 4.0);
      drive.go({4.0, 0.0, turn}, 4.0);
      const Ways ways = ways_of(drive, {4.0, 0.0, turn}, 4.0);
      EXPECT_NEAR(0.5 * (ways.left + ways.right) / ways.car, 1.0, 0.01) << share << ", " << turn;
      EXPECT_NEAR((ways.right - ways.left) / kTrack, ways.turn, 0.02 * ways.turn + 1e-6) << share << ", " << turn;
    }
}

TEST(Vehicle, WheelsSpinOnIceAndLock) {
  Drive start(family_on_ice());
  const Ways spinning = ways_of(start, {30.0}, 3.0);
  EXPECT_GT(spinning.car, 0.5);
  EXPECT_GT(spinning.left, 3.0 * spinning.car) << "full throttle";
  EXPECT_NEAR(start.report.wheels.left, 1.5f * 30.0f + 1.0f, 1.0f) << "the engine's limit";
  Drive stop(family_on_ice(), 15.0);
  stop.go({}, 1.0);
  const Ways locked = ways_of(stop, {}, 2.0);
  EXPECT_GT(locked.car, 15.0) << "it slides";
  EXPECT_NEAR(locked.left, 0.0, 0.01) << "full brakes";
}

// --- Robots of a fleet

world::Mover& add_car(world::World& world, const base::Pose& X_WM) {
  world::Mover& mover = scenes::add_mover(world, X_WM, scenes::rectangle({}, 4.2, 1.7));
  for (world::Segment& side : mover.body) side.z_max = 1.4;
  mover.drive = world::Drive::car, mover.wheelbase = kWheelbase, mover.track = kTrack, mover.max_forward = 30.0;
  mover.dynamics = {"car", {}, "a.world:7: "};
  return mover;
}

TEST(DynamicFleet, AWallStopsACar) {
  world::World world = scenes::boxed_world(100.0, 20.0);
  add_car(world, {50.0, 10.0, 0.0, 0.0});
  Fleet fleet(world);
  for (int tick = 0; tick < 150; ++tick) fleet.move(std::vector{base::Twist{10.0}}, 100'000'000);
  const base::Report& at = fleet.reports()[0];
  EXPECT_NEAR(at.X_WM.x, 100.0 - 2.1, 0.01);
  EXPECT_EQ(at.velocity.forward, 0.0);
  EXPECT_NE(at.contact_mask, 0u);
  EXPECT_FALSE(at.wheels.are_known()) << "they stop with the car";
  EXPECT_NEAR(at.X_WM.z, 0.0, 0.05);
  for (int tick = 0; tick < 30; ++tick) fleet.move(std::vector{base::Twist{-5.0}}, 100'000'000);
  EXPECT_LT(fleet.reports()[0].X_WM.x, 95.0) << "it drives away again";
}

TEST(DynamicFleet, ThreadsAndRestartsGiveTheSameBytes) {
  world::World world = scenes::boxed_world(200.0, 200.0);
  for (int k = 0; k < 40; ++k) add_car(world, {20.0 + 20.0 * (k % 8), 20.0 + 20.0 * (k / 8), 0.0, 0.3 * k});
  base::ThreadPool pool(4);
  Fleet one(world), four(world, &pool);
  const auto drive = [&](Fleet& fleet) {
    std::vector<base::Twist> commands(world.movers.size());
    for (std::uint32_t row = 0; row < commands.size(); ++row) commands[row] = {5.0 + 0.2 * row, 0.0, 0.4 - 0.02 * row};
    for (int tick = 0; tick < 20; ++tick) fleet.move(commands, 100'000'000);
    std::vector<double> numbers;
    for (const base::Report& r : fleet.reports())
      numbers.insert(numbers.end(), {r.X_WM.x, r.X_WM.y, r.X_WM.z, r.X_WM.yaw, r.tilt.roll, r.tilt.pitch,
                                     r.velocity.forward, r.velocity.left, r.velocity.turn});
    return numbers;
  };
  const auto first = drive(one);
  EXPECT_EQ(first, drive(four));
  for (std::uint32_t row = 0; row < world.movers.size(); ++row) one.restart(row);
  EXPECT_EQ(first, drive(one));
}

TEST(DynamicFleet, RefusesBadSettings) {
  const auto refusal = [](const std::string& key, const std::string& value, world::Drive drive = world::Drive::car) {
    world::World world = scenes::empty_world();
    world::Mover& mover = add_car(world, {});
    mover.drive = drive, mover.dynamics.settings = {{key, value}};
    return refusal_of([&] { Fleet fleet(world); });
  };
  EXPECT_EQ(refusal("mass", "1500"), "");
  EXPECT_EQ(refusal("mass", "heavy"), "a.world:7: 'dynamics': 'mass' is 'heavy'; expected a number from 0.1 to 100000");
  EXPECT_NE(refusal("mass", "nan"), "");
  EXPECT_NE(refusal("mass", "0"), "");
  EXPECT_NE(refusal("mas", "1").find("did you mean 'mass'?"), std::string::npos);
  EXPECT_NE(refusal("preset", "truck").find("family"), std::string::npos);
  EXPECT_NE(refusal("drive", "4x4").find("all"), std::string::npos);
  EXPECT_NE(refusal("preset", "pioneer").find("\"skid\""), std::string::npos) << "which cannot steer";
  EXPECT_NE(refusal("preset", "small", world::Drive::skid).find("drive \"car\""), std::string::npos);
  EXPECT_NE(refusal("spring", "2e7").find("too stiff"), std::string::npos);
  EXPECT_NE(refusal("mass", "50").find("expected at least 57.5 kg"), std::string::npos) << "as its wheels";
}

}  // namespace
}  // namespace sf::robots
