// Cars on kerbs, cliffs, drops and in the ground, and with heavy loads.

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "tests/refusal.h"
#include "tests/robots/vehicles.h"

namespace sf::robots {
namespace {

/// A square plateau about the origin; the floor is 0 m high beyond. @param side [m]
world::Terrain plateau(double height, double side) {
  return {.cell = {side, side}, .columns = 2, .rows = 2, .heights = std::vector(4, static_cast<float>(height))};
}

/// Returns the height [m] of the lowest corner of the body, sills and roof, above the floor.
double lowest_corner(const Vehicle& vehicle, const VehicleBody& body) {
  const glm::dvec3& box = vehicle.model().box;
  const glm::dmat3 R = base::rotation_of(body.q);
  const base::Report at = vehicle.report_of(body);
  double lowest = HUGE_VAL;
  for (unsigned k = 0; k < 8; ++k)
    lowest = std::min(lowest, at.X_WM.z + (R * glm::dvec3{(k & 1) != 0 ? box.x : -box.x, (k & 2) != 0 ? box.y : -box.y,
                                                          (k & 4) != 0 ? box.z : 0.3 * box.z})
                                              .z);
  return lowest;
}

TEST(VehicleGround, DrivesOverAKerb) {
  const world::Ramp pavement{.a = {10.0, 0.0}, .b = {200.0, 0.0}, .z_a = 0.1, .z_b = 0.1, .half_width = 5.0};
  const world::Ground ground({&pavement, 1});
  Drive drive(family_model(), 8.0, {}, ground);
  const base::Report at = drive.go({8.0}, 5.0);
  EXPECT_NEAR(at.X_WM.z, 0.1, 0.005);
  EXPECT_NEAR(at.velocity.forward, 8.0, 0.1);
}

TEST(VehicleGround, RisesSlowlyFromWithinTheGround) {
  for (const double depth : {0.3, 0.6, 2.0, 20.0}) {  // bump stops, corners, the roof, far below
    Drive drive(family_model());
    drive.report.X_WM.z = -depth;
    drive.vehicle.place(drive.report, drive.state);
    double last = -depth, highest = -depth;
    for (int k = 0; k < 300; ++k) {
      highest = std::max(highest, drive.go({}, 0.1).X_WM.z);
      EXPECT_LT(drive.report.X_WM.z - last, 0.2) << depth << " m deep, after " << k << " ticks";
      last = drive.report.X_WM.z;
    }
    EXPECT_NEAR(last, 0.0, 0.01) << depth;
    EXPECT_LT(highest, 0.2) << depth;
  }
}

TEST(VehicleGround, CliffsThrowNothing) {
  for (const double rise : {0.5, 1.0, 2.0, 4.0, 11.0, 57.0}) {  // within 1 m: up to 89 degrees
    const world::Terrain cliff = terrain_of([&](double x, double) { return x < 0.5 ? 0.0 : rise; });
    const world::Ground ground({}, {&cliff, 1});
    for (const double speed : {5.0, 20.0}) {
      const Vehicle vehicle(family_model());
      VehicleBody body = vehicle.body_at({.X_WM = {-10.0, 0.0, 0.0, 0.0}, .velocity = {speed, 0.0, 0.0}});
      const double start = body.p.z;
      double fastest = 0.0, highest = 0.0;
      for (int k = 0; k < 5'000; ++k) {
        vehicle.step(body, {}, kVehicleStep, ground);
        fastest = std::max(fastest, glm::length(body.v)), highest = std::max(highest, body.p.z - start);
      }
      EXPECT_LT(fastest, speed + 2.0) << rise << " m, at " << speed << " m/s";
      EXPECT_LT(highest, 0.5 * speed * speed / 9.81 + 2.5) << rise << " m, at " << speed << " m/s";
    }
  }
}

/// Upright borders, and cliffs thinner than the way that a car needs to stop, in front of it and behind.
TEST(VehicleGround, CliffsStopCars) {
  const world::Terrain high = plateau(20.0, 20.0);
  const world::Terrain thin{.X_WT = {10.0, 0.0}, .cell = {0.1, 50.0}, .columns = 401, .rows = 2, .heights = [] {
                              std::vector<float> heights(802);
                              for (std::size_t k = 0; k < heights.size(); ++k)
                                heights[k] = k % 401 > 200 ? 20.0f : 0.0f;
                              return heights;
                            }()};
  for (const auto& [terrain, face] : {std::pair{&high, -10.0}, {&thin, 10.1}}) {
    const world::Ground ground({}, {terrain, 1});
    for (const double speed : {5.0, -5.0}) {
      Drive drive(family_model(), speed, {}, ground);
      drive.report.X_WM = {face - 6.0, 0.0, 0.0, speed > 0.0 ? 0.0 : M_PI};
      drive.vehicle.place(drive.report, drive.state);
      double highest = 0.0;
      for (int k = 0; k < 30; ++k) highest = std::max(highest, drive.go({speed}, 0.1).X_WM.z);
      EXPECT_NEAR(drive.report.X_WM.x, face - 2.1, 0.3) << speed << " m/s";
      EXPECT_LT(highest, 0.3) << speed << " m/s";
    }
  }
}

TEST(VehicleGround, LiesOnItsRoofWhenUpsideDown) {
  const Vehicle vehicle(family_model());
  VehicleBody body = vehicle.body_at({.X_WM = {0.0, 0.0, 1.6}, .tilt = {.roll = 3.0}});
  for (int k = 0; k < 20'000; ++k) vehicle.step(body, {}, kVehicleStep, kFloor);
  EXPECT_NEAR(glm::length(body.v), 0.0, 1e-3);
  EXPECT_GT(body.p.z, 0.3);
}

TEST(VehicleGround, FallsFreelyBeyondADrop) {
  const world::Terrain high = plateau(20.0, 20.0),
                       inside = terrain_of([](double x, double) { return x < 10.5 ? 20.0 : 0.0; });
  for (const world::Terrain* terrain : {&high, &inside}) {
    const world::Ground ground({}, {terrain, 1});
    for (const auto& [preset, wheelbase, track] : kPresets) {
      VehicleModel model = vehicle_preset(preset, wheelbase, track);
      model.car.drag = 0.0;
      const Vehicle vehicle(model);
      for (const base::Tilt tilt : {base::Tilt{0.0, 0.8}, {0.0, 1.2}, {0.0, -0.8}, {0.9, 0.1}}) {
        VehicleBody body = vehicle.body_at({.X_WM = {30.0, 0.0, 20.0}, .tilt = tilt});
        const double start = body.p.z;
        for (int k = 0; k < 1'500; ++k) vehicle.step(body, {}, kVehicleStep, ground);
        EXPECT_NEAR(body.p.z, start - 0.5 * kGravity * 1.5 * 1.501, 1e-6) << preset << ", pitch " << tilt.pitch;
      }
    }
  }
}

TEST(VehicleGround, DrivesOffAPlateauOnToTheFloor) {
  const world::Terrain high = plateau(20.0, 20.0),
                       inside = terrain_of([](double x, double) { return x < 10.5 ? 20.0 : 0.0; });
  for (const world::Terrain* terrain : {&high, &inside}) {
    const world::Ground ground({}, {terrain, 1});
    for (const double speed : {1.0, 3.0, 10.0}) {
      Drive drive(family_model(), speed, {}, ground);
      drive.report.X_WM = {8.0, 0.0, 20.0};
      drive.vehicle.place(drive.report, drive.state);
      const base::Report at = drive.go({speed}, 2.0 / speed + 4.0);
      EXPECT_LT(at.X_WM.z, 2.5) << speed << " m/s: it fell 20 m within 2.02 s";
      EXPECT_LT(at.X_WM.x, 10.0 + 4.0 * speed) << speed;
    }
  }
}

/// Energy of a leap of v^2 / 2g, 1.3 cm at 0.5 m/s, and the largest slope of a body on a kerb bound the motion.
TEST(VehicleGround, APioneerRollsOverKerbsWithoutALeap) {
  const world::Terrain low = plateau(0.05, 4.0);
  const world::Ramp road{.a = {-2.0, 0.0}, .b = {2.0, 0.0}, .z_a = 0.05, .z_b = 0.05, .half_width = 2.0};
  const world::Ground grounds[] = {world::Ground({&road, 1}), world::Ground({}, {&low, 1})};
  for (const world::Ground& ground : grounds)
    for (const double yaw : {0.0, 0.5 * M_PI, 0.4}) {
      Drive drive(vehicle_preset("pioneer", 0.268, 0.394), 0.0, {.max_acceleration = 1.5}, ground);
      drive.report.X_WM = {-3.5 * std::cos(yaw), -3.5 * std::sin(yaw), 0.0, yaw};
      drive.vehicle.place(drive.report, drive.state);
      double highest = 0.0, steepest = 0.0;
      for (int k = 0; k < 150; ++k) {
        const base::Report at = drive.go({0.5}, 0.1);
        highest = std::max(highest, at.X_WM.z), steepest = std::max(steepest, std::abs(at.tilt.pitch));
      }
      EXPECT_GT(highest, 0.05) << "it reached the top";
      EXPECT_LT(highest, 0.05 + 0.013) << yaw;
      EXPECT_LT(steepest, 0.3) << "asin(0.05 / 0.268) is 0.19: " << yaw;
      EXPECT_NEAR(drive.report.X_WM.z, 0.0, 1e-3) << "and drove off again: " << yaw;
    }
}

/// Of any accepted settings.
TEST(VehicleGround, BearsItsWeightOnWheelsAndOnItsRoof) {
  EXPECT_TRUE(rc::check([] {
    const auto power = [](double least, double most) {
      return least * std::pow(most / least, 1e-3 * *rc::gen::inRange(0, 1'001));
    };
    world::Mover mover;
    mover.drive = world::Drive::car, mover.wheelbase = power(2.0, 12.0), mover.track = power(1.2, 3.0);
    const double height = power(0.3, 4.0), length = 0.7 * mover.wheelbase, width = 0.6 * mover.track;
    mover.body = {{.a = {length, width}, .b = {-length, -width}, .z_min = 0.0, .z_max = height}};
    mover.dynamics = {"car",
                      {{"mass", std::to_string(power(300.0, 1e5))},
                       {"height", std::to_string(power(0.1, 1.0) * height)},
                       {"spring", std::to_string(power(1e4, 1e6))}},
                      ""};
    std::optional<VehicleModel> model;
    try {
      model = vehicle_of(mover);
    } catch (const base::InputError&) {
    }
    RC_PRE(model.has_value());
    const Vehicle vehicle(*model, mover);
    VehicleBody stands = vehicle.body_at({}), lies = vehicle.body_at({.X_WM = {0.0, 0.0, height}, .tilt = {3.1, 0.0}});
    stands.w = {0.05, 0.05, 0.0};
    for (int k = 0; k < 1'500; ++k) {
      for (VehicleBody* body : {&stands, &lies}) vehicle.step(*body, {.brake = 5'000.0}, kVehicleStep, kFloor);
      RC_ASSERT(lowest_corner(vehicle, lies) > -0.3 * vehicle.static_compression(0) - 0.1);
    }
    RC_ASSERT(std::abs(vehicle.report_of(stands).X_WM.z) < 0.2 * vehicle.static_compression(0) + 1e-3);
    RC_ASSERT(std::abs(vehicle.report_of(stands).tilt.roll) < 0.05);
  }));
}

TEST(VehicleGround, RefusesCarsThatCannotStand) {
  const auto refusal = [](std::vector<std::pair<std::string, std::string>> settings) {
    world::Mover mover;
    mover.drive = world::Drive::car, mover.wheelbase = 6.0, mover.track = 2.0;
    mover.body = {{.a = {6.0, 1.25}, .b = {-6.0, -1.25}, .z_min = 0.0, .z_max = 3.5}};
    mover.dynamics = {"car", std::move(settings), ""};
    return refusal_of([&] { vehicle_of(mover); });
  };
  expect_in("too soft for this car of 40000 kg, whose centre of gravity is 2 m high; expected at least 295000 N/m",
            refusal({{"mass", "40000"}, {"height", "2"}}));
  EXPECT_EQ(refusal({{"mass", "40000"}, {"height", "2"}, {"spring", "295000"}}), "");
  expect_in("4 m high, above the body; expected at most 3.5 m", refusal({{"height", "4"}, {"spring", "60000"}}));
  EXPECT_EQ(refusal({{"height", "3.5"}, {"spring", "60000"}}), "") << "as high as its roof";
}

}  // namespace
}  // namespace sf::robots
