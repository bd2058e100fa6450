// Observers of sideslip: observability, convergence, consistency, and independence of the order of arrival.

#include "robots/estimation/sideslip.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <utility>
#include <vector>

#include "robots/estimation/chi_square.h"
#include "robots/runge_kutta.h"
#include "tests/instrumented.h"
#include "tests/units.h"

namespace sf::estimation {
namespace {

using Kind = SideslipMeasurement::Kind;
using Observer = SideslipObserver;
constexpr std::int64_t kSample = 10 * kMs;

robots::CarModel neutral_car() {
  robots::CarModel car;
  car.front_stiffness = car.rear_stiffness;
  return car;
}

SideslipModel model_of(Observer observer, const robots::CarModel& car = {}) {
  SideslipModel model;
  model.car = car, model.observer = observer;
  return model;
}

/// Moves a car by its single-track model.
SingleTrackState moved(const SideslipModel& model, const SingleTrackState& from, const SingleTrackInput& input) {
  return robots::runge_kutta(from, 0.01, [&](const SingleTrackState& at) { return rate(model.track(), at, input); });
}

TEST(SideslipObservability, IsThatOfTheTheory) {
  const SingleTrackState straight{25.0, 0.0, 0.0}, turning{25.0, -0.3, 0.2};
  const SingleTrack linear{{}, true}, own{{}, false}, neutral{neutral_car(), true}, neutral_own{neutral_car(), false};
  const MeasuredOutputs turn{.turn = true}, speed{.speed = true}, both{true, true};
  EXPECT_EQ(observability(linear, straight, {}, turn).rank, 2);
  EXPECT_GT(observability(linear, straight, {}, turn).left, 1.0);
  EXPECT_EQ(observability(neutral, straight, {}, turn).rank, 1) << "l_f C_f = l_r C_r";
  EXPECT_LT(observability(neutral, straight, {}, turn).left, 1e-6);
  EXPECT_EQ(observability(linear, straight, {}, speed).rank, 0) << "the speed is a parameter";
  EXPECT_LT(observability(own, straight, {}, speed).left, 1e-6) << "straight ahead the speed depends on nothing else";
  EXPECT_LT(observability(neutral_own, straight, {}, both).left, 1e-6);
  EXPECT_EQ(observability(own, turning, {0.03, 0.0}, both).rank, 3);
  EXPECT_EQ(observability(own, turning, {0.03, 0.0}, {}).rank, 0);
}

/// With its own model as the truth and no noise, each observer finds a sideslip that it did not know.
TEST(Sideslip, ObserversConvergeFasterThanTheCarItself) {
  for (const Observer observer :
       {Observer::luenberger, Observer::extended_luenberger, Observer::ekf, Observer::sliding_mode}) {
    SCOPED_TRACE(kSideslipObservers[static_cast<std::size_t>(observer)]);
    SideslipModel model = model_of(observer);
    model.pace = 2.0;
    model.left = 1.0, model.turn = 1e-4, model.turn_noise = 5e-4;  // a filter that trusts the yaw rate
    const SingleTrackInput input{0.01, 300.0};
    SingleTrackState truth{40.0, 0.5, 0.0};
    SideslipState state = started(model, 0, 40.0), alone = state;
    double worst = 0.0, worst_alone = 0.0;  // after half a second
    for (std::int64_t k = 1; k <= 100; ++k) {
      truth = moved(model, truth, input);
      for (SideslipState* each : {&state, &alone}) each->input = input;
      apply(model, {k * kSample, Kind::speed, 0, truth[kTrackForward]}, state);
      apply(model, {k * kSample, Kind::turn, 0, truth[kTrackTurn]}, state);
      alone = predict(model, alone, k * kSample);
      if (k < 50) continue;
      worst = std::max(worst, std::abs(state.mean[kTrackLeft] - truth[kTrackLeft]));
      worst_alone = std::max(worst_alone, std::abs(alone.mean[kTrackLeft] - truth[kTrackLeft]));
    }
    EXPECT_LT(worst, 0.2 * worst_alone);
    EXPECT_NEAR(state.mean[kTrackLeft], truth[kTrackLeft], 1e-3);
    EXPECT_NEAR(state.mean[kTrackTurn], truth[kTrackTurn], 1e-3);
  }
}

/// Where the yaw rate has no information on the sideways speed, no gain pretends that it had.
TEST(Sideslip, ANeutralCarsYawRateDoesNotCorrectTheSidewaysSpeed) {
  for (const Observer observer : {Observer::luenberger, Observer::extended_luenberger, Observer::sliding_mode}) {
    SCOPED_TRACE(kSideslipObservers[static_cast<std::size_t>(observer)]);
    for (const bool neutral : {false, true}) {
      const SideslipModel model = model_of(observer, neutral ? neutral_car() : robots::CarModel{});
      SideslipState state = started(model, 0, 25.0);
      apply(model, {0, Kind::turn, 0, 0.0}, state);
      const SingleTrackState before = predict(model, state, kSample).mean;
      apply(model, {kSample, Kind::turn, 0, 0.01}, state);
      EXPECT_GT(state.mean[kTrackTurn], before[kTrackTurn]);
      EXPECT_EQ(state.mean[kTrackLeft] == before[kTrackLeft], neutral);
    }
  }
}

/// 100 cars that follow the model and its noise: the mean normalized squared error is within its 95 % band.
TEST(Sideslip, CovarianceIsConsistentOver100Seeds) {
  const int seeds = instrumented() ? 10 : 100;
  SideslipModel model = model_of(Observer::ekf);
  double sum = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    std::normal_distribution<double> normal;
    SideslipState state = started(model, 0, 25.0);
    SingleTrackState truth{25.0 + model.speed_noise * normal(random), 0.2 * normal(random), 0.1 * normal(random)};
    const double densities[] = {model.forward, model.left, model.turn};
    for (std::int64_t k = 1; k <= 300; ++k) {
      const SingleTrackInput input{0.06 * std::sin(0.03 * static_cast<double>(k)), 150.0};
      truth = moved(model, truth, input);
      for (std::size_t c = 0; c < 3; ++c) truth[c] += std::sqrt(0.01 * densities[c]) * normal(random);
      state.input = input;
      apply(model, {k * kSample, Kind::speed, 0, truth[kTrackForward] + model.speed_noise * normal(random)}, state);
      apply(model, {k * kSample, Kind::turn, 0, truth[kTrackTurn] + model.turn_noise * normal(random)}, state);
    }
    SideslipEstimate estimate = estimate_of(model, state);
    EXPECT_NEAR(estimate.sideslip, std::atan2(truth[kTrackLeft], truth[kTrackForward]),
                5.0 * std::sqrt(estimate.covariance[0]));
    glm::dvec3 error;
    glm::dmat3 P;
    for (int c = 0; c < 3; ++c) {
      error[c] = truth[static_cast<std::size_t>(c)] - state.mean[static_cast<std::size_t>(c)];
      for (int r = 0; r < 3; ++r) P[c][r] = state.covariance[static_cast<std::size_t>(3 * c + r)];
    }
    sum += glm::dot(error, glm::inverse(P) * error);
  }
  EXPECT_GT(sum, chi_square_limit(3 * seeds, 0.975));
  EXPECT_LT(sum, chi_square_limit(3 * seeds, 0.025));
}

TEST(Sideslip, OrderOfArrivalDoesNotMatter) {
  EXPECT_TRUE(rc::check([] {
    const auto observer = static_cast<Observer>(*rc::gen::inRange(0, 4));
    const SideslipModel model = model_of(observer);
    std::vector<SideslipMeasurement> measurements;
    for (std::uint32_t k = 0; k < 40; ++k)
      measurements.push_back(
          {1 + k / 4 * kSample, static_cast<Kind>(k % 4), k, k % 4 == 2 ? 25.0 : 0.01 * *rc::gen::inRange(-10, 11)});
    const auto end = [&] {
      MeasurementWindow<SideslipMeasurement, SideslipState> window(kSecond, 64);
      for (const SideslipMeasurement& m : measurements)
        window.take(m, [&](const SideslipMeasurement& each, SideslipState& s) { return apply(model, each, s); });
      return *window.state_at(kSecond);
    };
    const SideslipState first = end();
    for (std::size_t k = measurements.size(); k-- > 1;)
      std::swap(measurements[k], measurements[*rc::gen::inRange<std::size_t>(0, k + 1)]);
    const SideslipState other = end();
    RC_ASSERT(first.mean == other.mean);
    RC_ASSERT(first.covariance == other.covariance);
  }));
}

TEST(Sideslip, StartsWithASpeedAndStopsWithoutReadings) {
  const SideslipModel model;
  SideslipState state;
  EXPECT_EQ(apply(model, {1, Kind::turn, 0, 0.1}, state), Verdict::no_track);
  EXPECT_EQ(apply(model, {2, Kind::steer, 0, 0.02}, state), Verdict::used);
  EXPECT_EQ(apply(model, {3, Kind::speed, 0, kNaN}, state), Verdict::invalid);
  EXPECT_EQ(apply(model, {4, Kind::speed, 0, 25.0}, state), Verdict::started);
  EXPECT_EQ(state.input.steer, 0.02) << "inputs are kept";
  EXPECT_TRUE(predict(model, state, 4 + kSideslipGap).known());
  EXPECT_FALSE(predict(model, state, 5 + kSideslipGap).known());
  EXPECT_EQ(predict(model, state, 3).at, 4) << "never backwards";
  EXPECT_TRUE(std::isnan(estimate_of(model_of(Observer::luenberger), state).covariance[0]));
  EXPECT_GT(estimate_of(model, state).covariance[0], 0.0);
}

}  // namespace
}  // namespace sf::estimation
