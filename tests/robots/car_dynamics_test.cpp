// The four-wheel model of a car: convergence, steady cornering, balances of energy and momentum, symmetry, limits.

#include "robots/car_dynamics.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <numeric>

#include "tests/units.h"

namespace sf::robots {
namespace {

CarState drive(const CarModel& model, CarState state, double seconds, double dt, const auto& command) {
  const auto steps = std::lround(seconds / dt);
  for (long k = 0; k < steps; ++k) state = step(model, state, command(static_cast<double>(k) * dt, state), dt);
  return state;
}

/// Kinetic energy [J] of the body and of its wheels.
double energy(const CarModel& m, const CarState& s) {
  double sum = 0.5 * m.mass * (s[kCarForward] * s[kCarForward] + s[kCarLeft] * s[kCarLeft]) +
               0.5 * m.inertia * s[kCarTurn] * s[kCarTurn];
  for (std::size_t k = 0; k < kWheels; ++k) sum += 0.5 * m.wheel_inertia * s[kCarSpin + k] * s[kCarSpin + k];
  return sum;
}

CarModel without_resistance() {
  CarModel model;
  model.drag = model.rolling = 0.0;
  return model;
}

/// A state between 5 and 40 m/s with any slip of body and wheels.
CarState any_state(const CarModel& model) {
  const auto within = [](double most) { return most * 1e-4 * *rc::gen::inRange(-10'000, 10'001); };
  CarState state = straight(model, 22.5 + within(17.5));
  state[kCarLeft] = within(4.0), state[kCarTurn] = within(1.0), state[kCarSteer] = within(0.3);
  for (std::size_t k = 0; k < kWheels; ++k) state[kCarSpin + k] *= 1.0 + within(0.3);
  return state;
}

TEST(CarDynamics, ErrorsFallWithTheStep) {
  const CarModel model;
  const auto end = [&](double dt) {
    return drive(model, straight(model, 25.0), 2.0, dt, [](double t, const CarState&) {
      return CarCommand{0.06 * std::sin(3.0 * t), 200.0};
    });
  };
  const CarState fine = end(kCarStep / 8.0), usual = end(kCarStep), half = end(kCarStep / 2.0);
  const auto error = [&](const CarState& s) {
    return std::abs(s[kCarLeft] - fine[kCarLeft]) + std::abs(s[kCarTurn] - fine[kCarTurn]);
  };
  EXPECT_LT(error(usual), 5e-4);
  EXPECT_LT(error(half), 0.6 * error(usual)) << "of order one, since a command is held for a step";
  const auto coast = [&](double dt) {
    CarState start = straight(model, 25.0);
    start[kCarLeft] = -1.0, start[kCarTurn] = 0.4, start[kCarSteer] = 0.05;
    for (std::size_t k = 0; k < kWheels; ++k) start[kCarSpin + k] *= 1.1;
    return drive(model, start, 0.1, dt, [](double, const CarState&) { return CarCommand{0.05, 0.0}; });
  };
  const CarState reference = coast(kCarStep / 16.0);
  const auto off = [&](double dt) { return std::abs(coast(dt)[kCarLeft] - reference[kCarLeft]); };
  EXPECT_LT(off(kCarStep), 1e-6);
  EXPECT_LT(off(kCarStep / 2.0), off(kCarStep) / 7.0) << "order four, less where a wheel passes from drive to brake";
}

/// On a circle the steering angle is l / R + K a, and the sideslip is that of the rear axle's slip.
TEST(CarDynamics, SteadyCorneringFollowsTheUndersteerGradient) {
  CarModel model;
  model.load_loss = 0.0;
  for (const double gradient : {1.0, 0.0}) {
    if (gradient == 0.0) model.front_stiffness = model.rear_stiffness;
    SCOPED_TRACE(gradient);
    const CarState s = drive(model, straight(model, 20.0), 6.0, kCarStep, [](double, const CarState& at) {
      return CarCommand{0.002, 2000.0 * (20.0 - at[kCarForward])};
    });
    const double v = s[kCarForward], a = car_forces(model, s).left, radius = v / s[kCarTurn];
    EXPECT_GT(a, 0.15);
    EXPECT_NEAR(0.002, model.wheelbase() / radius + model.understeer() * a, 0.02 * 0.002);
    const double rear_slip = model.mass * model.front * a / (model.wheelbase() * model.rear_cornering());
    EXPECT_NEAR(sideslip(s), model.rear / radius - rear_slip, 3e-5);
  }
  EXPECT_NEAR(model.understeer(), 0.0, 1e-12);
  EXPECT_NEAR(CarModel{}.understeer() * kGravity / kDegree, 1.6, 0.05);
}

TEST(CarDynamics, TyresOnlyTakeEnergy) {
  EXPECT_TRUE(rc::check([] {
    const CarModel model = without_resistance();
    CarState state = any_state(model);
    double before = energy(model, state);
    for (int k = 0; k < 200; ++k) {
      state = step(model, state, {state[kCarSteer], 0.0});
      RC_ASSERT(energy(model, state) <= before + 1e-6);
      before = energy(model, state);
    }
  }));
}

/// The engine's work, minus the losses by slip, is the change of energy; the tyres' impulse that of momentum.
TEST(CarDynamics, BalancesOfEnergyAndMomentumHold) {
  const CarModel model = without_resistance();
  CarState state = straight(model, 20.0);
  const double before = energy(model, state);
  double work = 0.0, impulse_x = 0.0, impulse_y = 0.0;
  const auto power = [&](const CarState& s) {
    const CarForces f = car_forces(model, s);
    double sum = 0.0;
    for (std::size_t k = 0; k < kWheels; ++k) {
      const double x = k < kRearLeft ? model.front : -model.rear, steer = k < kRearLeft ? s[kCarSteer] : 0.0;
      const double y = (k % 2 == 0 ? 0.5 : -0.5) * (k < kRearLeft ? model.front_track : model.rear_track);
      const double vx = s[kCarForward] - s[kCarTurn] * y, vy = s[kCarLeft] + s[kCarTurn] * x;
      const double rim = s[kCarSpin + k] * model.wheel_radius;
      sum += f.along[k] * (std::cos(steer) * vx + std::sin(steer) * vy - rim) +
             f.across[k] * (std::cos(steer) * vy - std::sin(steer) * vx);
      if (k < kRearLeft) sum += 0.5 * s[kCarTorque] * s[kCarSpin + k];
    }
    return sum;
  };
  for (int k = 0; k < 4000; ++k) {
    const CarState next = step(model, state, {0.08, 1000.0});
    work += 0.5 * kCarStep * (power(state) + power(next));
    for (const CarState& s : {state, next}) {
      const CarForces f = car_forces(model, s);
      const double c = std::cos(s[kCarYaw]), n = std::sin(s[kCarYaw]), half = 0.5 * kCarStep * model.mass;
      impulse_x += half * (c * f.forward - n * f.left), impulse_y += half * (n * f.forward + c * f.left);
    }
    state = next;
  }
  const double c = std::cos(state[kCarYaw]), n = std::sin(state[kCarYaw]);
  EXPECT_NEAR(energy(model, state) - before, work, 1e-4 * before);
  EXPECT_NEAR(impulse_x, model.mass * (c * state[kCarForward] - n * state[kCarLeft] - 20.0), 1.0);
  EXPECT_NEAR(impulse_y, model.mass * (n * state[kCarForward] + c * state[kCarLeft]), 1.0);
}

TEST(CarDynamics, AMirroredCarMovesMirrored) {
  EXPECT_TRUE(rc::check([] {
    const CarModel model;
    CarState left = any_state(model), right = left;
    for (const std::size_t k : {kCarLeft, kCarTurn, kCarSteer}) right[k] = -right[k];
    std::swap(right[kCarSpin], right[kCarSpin + 1]);
    std::swap(right[kCarSpin + 2], right[kCarSpin + 3]);
    for (int k = 0; k < 50; ++k) {
      left = step(model, left, {0.1, -500.0});
      right = step(model, right, {-0.1, -500.0});
    }
    RC_ASSERT(std::abs(left[kCarLeft] + right[kCarLeft]) < 1e-9);
    RC_ASSERT(std::abs(left[kCarTurn] + right[kCarTurn]) < 1e-9);
    RC_ASSERT(std::abs(left[kCarForward] - right[kCarForward]) < 1e-9);
  }));
}

TEST(CarDynamics, ForcesStayWithinFrictionAndLoadsAddUpToTheWeight) {
  EXPECT_TRUE(rc::check([] {
    CarModel model;
    model.load_loss = 0.0;
    const CarForces f = car_forces(model, any_state(model));
    bool lifted = false;
    for (std::size_t k = 0; k < kWheels; ++k) {
      RC_ASSERT(std::hypot(f.along[k], f.across[k]) <= 1.18 * f.load[k] + 1e-9);
      lifted = lifted || f.load[k] == 0.0;
    }
    const double sum = std::accumulate(f.load.begin(), f.load.end(), 0.0);
    RC_ASSERT(lifted || std::abs(sum - model.mass * kGravity) < 1e-3);
  }));
}

TEST(CarDynamics, ActuatorsAreLimited) {
  const CarModel model;
  const CarState turned = drive(model, straight(model, 25.0), 0.1, kCarStep, [](double, const CarState&) {
    return CarCommand{5.0, 1e9};
  });
  EXPECT_NEAR(turned[kCarSteer], 0.04, 1e-12) << "0.4 rad/s";
  EXPECT_NEAR(turned[kCarTorque], model.drive_limit * (1.0 - std::exp(-1.0)), 0.1);
  const CarState stopped = drive(model, straight(model, 25.0), 5.0, kCarStep, [](double, const CarState&) {
    return CarCommand{0.0, -1e9};
  });
  EXPECT_LT(std::abs(stopped[kCarForward]), 0.1);
  EXPECT_GT(stopped[kCarX], 25.0 * 25.0 / (2.0 * 1.18 * kGravity)) << "the shortest way that friction permits";
  EXPECT_LT(stopped[kCarX], 45.0);
}

}  // namespace
}  // namespace sf::robots
