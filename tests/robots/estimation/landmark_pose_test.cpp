#include "robots/estimation/landmark_pose.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <random>
#include <vector>

#include "robots/estimation/localization.h"
#include "tests/units.h"

namespace sf::estimation {
namespace {

constexpr base::Pose kSeenFrom{0.5, -0.3, 0.0, 2.1};
constexpr glm::dvec2 kOne{3.0, 1.0}, kTwo{-1.0, 4.0}, kThree{-2.0, -3.0};
constexpr double kSigma = 0.02;  // [m]

/// A sighting from kSeenFrom, off by `error` in the robot's frame.
WheeledMeasurement sighting(std::int64_t time, const glm::dvec2& landmark, const glm::dvec2& error = {}) {
  const glm::dvec2 seen = base::transform(base::inverse(kSeenFrom), landmark) + error;
  return {.time = time,
          .kind = WheeledMeasurement::Kind::sighting,
          .values = {seen.x, seen.y, 0.0},
          .covariance = {kSigma * kSigma, 0.0, 0.0, kSigma * kSigma, 0.0, 1.0},
          .landmark = {landmark.x, landmark.y}};
}

Verdict add(Localization& to, const WheeledMeasurement& m) {
  return to.add_sighting(m.time, {m.landmark[0], m.landmark[1]}, {m.values[0], m.values[1]},
                         {m.covariance[0], m.covariance[1], m.covariance[3]});
}

double distance(const Localization& of, std::int64_t time) {
  const base::Pose X = of.predict(time).estimate.X_WM;
  return std::hypot(X.x - kSeenFrom.x, X.y - kSeenFrom.y) + std::abs(base::wrap_angle(X.yaw - kSeenFrom.yaw));
}

TEST(LandmarkPose, ErrorsMatchTheStatedCovariance) {
  constexpr int kDraws = 2000;
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0.0, kSigma);
  for (const std::size_t count : {2, 3}) {
    double sum = 0.0;
    for (int k = 0; k < kDraws; ++k) {
      std::vector<WheeledMeasurement> seen;
      for (const glm::dvec2& p : std::array{kOne, kTwo, kThree})
        if (seen.size() < count) seen.push_back(sighting(0, p, {normal(random), normal(random)}));
      const auto pose = pose_of(seen);
      ASSERT_TRUE(pose) << k;
      const std::array<double, 3> e{pose->values[0] - kSeenFrom.x, pose->values[1] - kSeenFrom.y,
                                    base::wrap_angle(pose->values[2] - kSeenFrom.yaw)};
      const auto& c = pose->covariance;
      const glm::dmat3 P{{c[0], c[1], c[2]}, {c[1], c[3], c[4]}, {c[2], c[4], c[5]}};
      const glm::dvec3 error{e[0], e[1], e[2]};
      sum += glm::dot(error, glm::inverse(P) * error);
    }
    // Three standard deviations of a mean of chi-square variables with three degrees of freedom.
    EXPECT_NEAR(sum / kDraws, 3.0, 3.0 * std::sqrt(6.0 / kDraws)) << count;
  }
}

TEST(LandmarkPose, RefusesWhatDoesNotDetermineAPose) {
  const auto refused = [](const std::vector<WheeledMeasurement>& seen) { return !pose_of(seen); };
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused({sighting(0, kOne)})) << "one landmark leaves a circle";
  EXPECT_TRUE(refused({sighting(0, kOne), sighting(0, kOne)})) << "the same one twice, too";
  EXPECT_TRUE(refused({sighting(0, kOne), sighting(0, kOne + glm::dvec2{0.1, 0.0})})) << "heading to 0.28 rad only";
  EXPECT_FALSE(refused({sighting(0, kOne), sighting(0, kOne + glm::dvec2{0.4, 0.0})})) << "to 0.07 rad";
}

TEST(LandmarkPose, RefusesSightingsThatContradictEachOther) {
  const auto mistaken = [](double error) {
    WheeledMeasurement second = sighting(0, kTwo);
    const glm::dvec2 apart = kTwo - kOne;
    const glm::dvec2 wrong = kOne + apart * (1.0 + error / glm::length(apart));
    second.landmark = {wrong.x, wrong.y};
    return pose_of(std::array{sighting(0, kOne), second});
  };
  // The distance between both has a standard deviation of 0.028 m; the gate is at 3.9 of them.
  EXPECT_TRUE(mistaken(0.1));
  EXPECT_FALSE(mistaken(0.12));
  EXPECT_FALSE(mistaken(-1.0));
}

TEST(Localization, TwoLandmarksOfOneTimeStartAPose) {
  Localization localization({.encoder = LocalizationOptions::Encoder{}});
  EXPECT_EQ(add(localization, sighting(0, kOne)), Verdict::no_track);
  EXPECT_EQ(add(localization, sighting(kTick, kTwo)), Verdict::no_track) << "the robot may have moved in between";
  EXPECT_EQ(localization.predict(kTick).status, Prediction::Status::none);
  EXPECT_EQ(add(localization, sighting(kTick, kThree)), Verdict::started);
  EXPECT_LT(distance(localization, kTick), 1e-9);
  const double variance = localization.predict(kTick).estimate.covariance[kYaw * (kComponents + 1)];
  EXPECT_EQ(add(localization, sighting(kTick, kOne)), Verdict::used) << "a third one corrects it";
  EXPECT_LT(localization.predict(kTick).estimate.covariance[kYaw * (kComponents + 1)], variance);
}

/// Both landmarks are taken for others at the same distance from each other, until each is recognised.
TEST(Localization, LandmarksReplaceAWrongStart) {
  Localization localization({.encoder = LocalizationOptions::Encoder{}});
  WheeledMeasurement first = sighting(0, kOne), second = sighting(0, kTwo);
  first.landmark = {10.0, 10.0}, second.landmark = {10.0, 10.0 + glm::length(kTwo - kOne)};
  add(localization, first);
  EXPECT_EQ(add(localization, second), Verdict::started);
  EXPECT_GT(distance(localization, 0), 5.0);
  std::int64_t time = 0, found = 0;
  for (int k = 1; k <= 20; ++k) {
    time = k * kTick;
    localization.add_encoder(time, 0.0, 0.0);
    add(localization, sighting(time, kOne));
    if (add(localization, sighting(time, kTwo)) == Verdict::started) found = time;
  }
  EXPECT_GT(found, Localization::kRelocated);
  EXPECT_LT(distance(localization, time), 1e-3);
}

}  // namespace
}  // namespace sf::estimation
