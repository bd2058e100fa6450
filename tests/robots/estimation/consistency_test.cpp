// Consistency of the filter with its own model over 1000 simulated runs: errors match the covariance (NEES),
// innovations match their covariance (NIS), and innovations at different times are uncorrelated.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "base/time.h"
#include "robots/estimation/chi_square.h"
#include "robots/estimation/kalman.h"
#include "tests/robots/estimation/reference.h"
#include "tests/robots/estimation/truth.h"

namespace sf::estimation {
namespace {

constexpr int kRuns = 1000;
constexpr int kSteps = 30;
constexpr std::int64_t kInterval = 100'000'000;

struct Sums {
  std::array<double, kSteps> nees{};  ///< over runs, per step
  std::array<double, kSteps> nis{};
  int nees_degrees = 0;  ///< per run and step
  int nis_degrees = 0;
};

/// @param model the true model
/// @param assumed the filter's model
Sums simulate(const MotionModel& model, const MotionModel& assumed, std::uint8_t components) {
  Sums sums;
  std::mt19937_64 random(1);
  for (int run = 0; run < kRuns; ++run) {
    reference::Truth truth{{1e4, -2e4, 3.0, 0.5, 0.0, 0.3}, random, {}};
    Estimate e = first_estimate(assumed, truth.measure(kPoseBits | kTwistBits, 0));
    for (int k = 0; k < kSteps; ++k) {
      truth.move(model, 1e-9 * kInterval);
      e = predict(assumed, e, e.time + kInterval);
      const Measurement m = truth.measure(components, e.time);
      const Innovation surprise = innovation(e, m);
      sums.nis[k] += surprise.squared;
      sums.nis_degrees = surprise.degrees;
      e = correct(e, m);
      sums.nees[k] += reference::nees(e, truth.s, sums.nees_degrees);
    }
  }
  return sums;
}

/// Returns the number of steps whose sum over runs is outside the central 99 % of its distribution.
int outside(const std::array<double, kSteps>& sums, int degrees) {
  const double low = chi_square_limit(kRuns * degrees, 0.995);
  const double high = chi_square_limit(kRuns * degrees, 0.005);
  int count = 0;
  for (const double sum : sums) count += sum < low || sum > high;
  return count;
}

// Of 30 steps, 0.3 are outside by chance (correlated within a run); 4 or more have a probability of about 1e-3.
constexpr int kMostOutside = 3;

struct Case {
  const char* name;
  MotionModel model;
  std::uint8_t components;
};
const std::vector<Case> kCases{{"wheels, pose and twist", differential_drive(0.05, 0.2), kPoseBits | kTwistBits},
                               {"wheels, pose", differential_drive(0.05, 0.2), kPoseBits},
                               {"body, pose and twist", free_body(0.05, 0.2), kPoseBits | kTwistBits},
                               {"body, pose", free_body(0.05, 0.2), kPoseBits},
                               {"omni, position and turn rate",
                                {MotionModel::Path::arc, 0.05, 0.05, 0.2},
                                kPositionBits | 1u << kYaw | 1u << kTurn}};

TEST(Consistency, ErrorsMatchTheCovariance) {
  for (const Case& c : kCases) {
    const Sums sums = simulate(c.model, c.model, c.components);
    EXPECT_LE(outside(sums.nees, sums.nees_degrees), kMostOutside) << c.name;
    EXPECT_LE(outside(sums.nis, sums.nis_degrees), kMostOutside) << c.name;
    EXPECT_EQ(sums.nees_degrees, c.model.left > 0.0 ? 6 : 5) << c.name;
  }
}

TEST(Consistency, BoundsDetectAWrongModel) {
  // A filter that assumes half or twice the noise fails the same test in nearly every step.
  const MotionModel model = differential_drive(0.05, 0.2);
  for (const double factor : {0.5, 2.0}) {
    const Sums sums = simulate(model, differential_drive(factor * 0.05, factor * 0.2), kPoseBits);
    EXPECT_GT(outside(sums.nees, sums.nees_degrees), kSteps / 2) << factor;
    EXPECT_GT(outside(sums.nis, sums.nis_degrees), kSteps / 2) << factor;
  }
}

}  // namespace
}  // namespace sf::estimation
