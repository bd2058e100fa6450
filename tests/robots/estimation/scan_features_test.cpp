// Features in scans of a known room: their positions, and the consistency of their covariance over 100 seeds.

#include "robots/estimation/scan_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/bearing.h"
#include "base/random.h"
#include "robots/estimation/chi_square.h"

namespace sf::estimation {
namespace {

constexpr double kNoRange = std::numeric_limits<double>::quiet_NaN();
constexpr int kScanSeeds = 100;

struct Wall {
  glm::dvec2 a, b;
};

/// Ranges [m] of a sensor at X_WS to walls and a disc, up to `longest`.
std::vector<double> ranges_in(const std::vector<Wall>& walls, glm::dvec2 disc, double radius, const base::Pose& X_WS,
                              const std::vector<double>& bearings, double longest = 8.0) {
  std::vector<double> ranges;
  for (const double bearing : bearings) {
    const glm::dvec2 u = base::rotate(X_WS.yaw + bearing, {1.0, 0.0}), p{X_WS.x, X_WS.y};
    double nearest = longest;
    for (const Wall& wall : walls) {
      const glm::dvec2 along = wall.b - wall.a, from = wall.a - p;
      const double cross = base::cross(u, along);
      if (std::abs(cross) < 1e-12) continue;
      const double range = base::cross(from, along) / cross, share = base::cross(from, u) / cross;
      if (range > 0.0 && share >= 0.0 && share <= 1.0) nearest = std::min(nearest, range);
    }
    const glm::dvec2 d = disc - p;
    const double ahead = glm::dot(d, u), off = radius * radius - (glm::dot(d, d) - ahead * ahead);
    if (off > 0.0 && ahead > 0.0) nearest = std::min(nearest, ahead - std::sqrt(off));
    ranges.push_back(nearest < longest ? nearest : kNoRange);
  }
  return ranges;
}

std::vector<double> bearings_over(double fov, std::uint32_t samples) {
  std::vector<double> bearings;
  for (std::uint32_t i = 0; i < samples; ++i) bearings.push_back(base::bearing_of(fov, samples, i));
  return bearings;
}

const std::vector<Wall> kRoom{{{0, 0}, {4, 0}}, {{4, 0}, {4, 3}}, {{4, 3}, {0, 3}}, {{0, 3}, {0, 0}}};
const base::Pose kSensor{1.2, 1.0, 0.0, 0.3};
constexpr glm::dvec2 kNowhere{-50.0, -50.0};

/// Features of the room in the world frame: the sensor's pose is that of its robot in the world.
std::vector<Feature> seen(glm::dvec2 disc, double radius, double fov, const EchoNoise& noise, std::uint64_t seed) {
  const auto bearings = bearings_over(fov, fov > 6.0 ? 721 : 361);
  ScanFeatures finder(kSensor, bearings, noise, {});
  std::vector<double> ranges = ranges_in(kRoom, disc, radius, kSensor, bearings);
  for (std::uint32_t i = 0; i < ranges.size(); ++i)
    ranges[i] += std::hypot(noise.constant, noise.proportional * ranges[i]) *
                 base::random_normal({seed, base::RandomStream::range_noise}, i)[0];
  const auto found = finder.find(ranges);
  return {found.begin(), found.end()};
}

std::vector<Feature> of_kind(const std::vector<Feature>& all, FeatureKind kind) {
  std::vector<Feature> some;
  std::ranges::copy_if(all, std::back_inserter(some), [&](const Feature& f) { return f.kind == kind; });
  return some;
}

TEST(ScanFeatures, FindTheLinesAndCornersOfARoom) {
  const auto all = seen(kNowhere, 0.1, 2.0 * M_PI, {}, 1);
  const auto lines = of_kind(all, FeatureKind::line), corners = of_kind(all, FeatureKind::corner);
  ASSERT_EQ(all.size(), lines.size() + corners.size());
  ASSERT_EQ(lines.size(), 4u);
  double length = 0.0;
  for (const Feature& line : lines) {
    length += 2.0 * line.half_length;
    const double off =
        std::min({std::abs(line.p.x), std::abs(line.p.x - 4.0), std::abs(line.p.y), std::abs(line.p.y - 3.0)});
    EXPECT_LT(off, 1e-3);
    EXPECT_LT(std::abs(std::sin(2.0 * line.direction)), 1e-3);
  }
  EXPECT_NEAR(length, 14.0, 0.4) << "without the joints";
  ASSERT_GE(corners.size(), 3u) << "one may be where the scan is cut";
  for (const Feature& corner : corners) {
    EXPECT_LT(std::min(std::abs(corner.p.x), std::abs(corner.p.x - 4.0)), 1e-3);
    EXPECT_LT(std::min(std::abs(corner.p.y), std::abs(corner.p.y - 3.0)), 1e-3);
    const glm::dvec2 inward = glm::dvec2{2.0, 1.5} - corner.p;
    EXPECT_NEAR(base::wrap_angle(std::atan2(inward.y > 0 ? 1 : -1, inward.x > 0 ? 1 : -1) - corner.direction), 0.0,
                1e-3);
  }
}

TEST(ScanFeatures, ADiscIsOneClusterWhoseMiddleIsNearItsAxis) {
  const glm::dvec2 disc{2.6, 1.6};
  const auto clusters = of_kind(seen(disc, 0.165, M_PI, {.constant = 0.01}, 1), FeatureKind::cluster);
  ASSERT_EQ(clusters.size(), 1u);
  EXPECT_LT(glm::length(clusters[0].p - disc), 0.08) << "in front of it";
  EXPECT_NEAR(clusters[0].half_length, 0.165, 0.03);
  EXPECT_TRUE(std::isnan(clusters[0].direction));
}

/// What a sensor at the origin sees of a rectangle of this size at 15 m to the right of its x axis.
Feature seen_of(glm::dvec2 size, double yaw, std::uint64_t seed) {
  const glm::dvec2 middle{15.0, -3.0}, x = base::rotate(yaw, {0.5 * size.x, 0.0}),
                                       y = base::rotate(yaw, {0.0, 0.5 * size.y});
  const glm::dvec2 corners[] = {middle + x + y, middle - x + y, middle - x - y, middle + x - y};
  std::vector<Wall> walls;
  for (int k = 0; k < 4; ++k) walls.push_back({corners[k], corners[(k + 1) % 4]});
  const auto bearings = bearings_over(M_PI / 2.0, 226);
  std::vector<double> ranges = ranges_in(walls, kNowhere, 0.1, {}, bearings, 50.0);
  for (std::uint32_t i = 0; i < ranges.size(); ++i)
    ranges[i] += 0.02 * base::random_normal({seed, base::RandomStream::range_noise}, i)[0];
  ScanFeatures finder({}, bearings, {.constant = 0.02}, {.shortest = 5.5, .widest = 5.0, .size = {4.2, 1.7}});
  const auto found = finder.find(ranges);
  return found.empty() ? Feature{} : *std::ranges::max_element(found, {}, &Feature::kind);
}

TEST(ScanFeatures, ClustersAreCompletedToObjectsOfKnownSize) {
  for (int k = 0; k < 24; ++k) {
    // End on, sides on and all oblique views: behind what is seen, the middle follows from the size.
    const double yaw = M_PI * k / 24.0;
    const Feature car = seen_of({4.2, 1.7}, yaw, static_cast<std::uint64_t>(k));
    ASSERT_EQ(car.kind, FeatureKind::object) << k;
    EXPECT_LT(glm::length(car.p - glm::dvec2{15.0, -3.0}), 0.35) << k;
    EXPECT_NEAR(std::sin(car.direction - yaw), 0.0, 0.15) << k;
    EXPECT_GT(car.covariance[0] * car.covariance[3], 0.0);
  }
  EXPECT_EQ(seen_of({0.5, 0.5}, 0.3, 1).kind, FeatureKind::cluster) << "a trunk is too narrow";
  EXPECT_EQ(seen_of({4.95, 0.2}, 1.5, 1).kind, FeatureKind::cluster) << "a fence is too long";
}

TEST(ScanFeatures, SurviveScansWithoutEchoesAndWithAbsurdOnes) {
  ScanFeatures finder({}, bearings_over(M_PI, 5), {.constant = 0.01}, {});
  EXPECT_TRUE(finder.find(std::vector<double>(5, kNoRange)).empty());
  EXPECT_TRUE(finder.find(std::vector<double>(5, 0.0)).empty());
  EXPECT_TRUE(finder.find(std::vector<double>{-1.0, 1e300, HUGE_VAL, -HUGE_VAL, kNoRange}).empty());
  EXPECT_EQ(finder.find(std::vector<double>{1.0, kNoRange, 3.0, kNoRange, 1.0}).size(), 3u) << "single echoes";
  ScanFeatures one({}, {0.0}, {}, {});
  ASSERT_EQ(one.find(std::vector<double>{2.0}).size(), 1u);
  EXPECT_EQ(one.find(std::vector<double>{2.0})[0].kind, FeatureKind::cluster);
}

/// Sums the squared errors of lines (offset and direction) and corners (position) over their covariance.
struct Consistency {
  double lines = 0.0, corners = 0.0;
  int line_terms = 0, corner_terms = 0;

  void add_line(const Feature& line) {
    const auto& c = line.covariance;
    const glm::dvec2 n{-std::sin(line.direction), std::cos(line.direction)};
    const bool upright = std::abs(n.x) > 0.5;
    const double at = upright ? (line.p.x < 2.0 ? 0.0 : 4.0) : (line.p.y < 1.5 ? 0.0 : 3.0);
    const double turn = 0.5 * base::wrap_angle(2.0 * (line.direction - (upright ? 0.5 * M_PI : 0.0)));
    const double v = n.x * n.x * c[0] + 2.0 * n.x * n.y * c[1] + n.y * n.y * c[3], w = n.x * c[2] + n.y * c[4];
    const double determinant = v * c[5] - w * w;
    const double e = upright ? (line.p.x - at) * n.x : (line.p.y - at) * n.y;
    lines += (c[5] * e * e - 2.0 * w * e * turn + v * turn * turn) / determinant;
    line_terms += 2;
  }
  void add_corner(const Feature& corner) {
    const auto& c = corner.covariance;
    const glm::dvec2 e = corner.p - glm::dvec2{corner.p.x < 2.0 ? 0.0 : 4.0, corner.p.y < 1.5 ? 0.0 : 3.0};
    corners += (c[3] * e.x * e.x - 2.0 * c[1] * e.x * e.y + c[0] * e.y * e.y) / (c[0] * c[3] - c[1] * c[1]);
    corner_terms += 2;
  }
};

TEST(ScanFeatures, CovarianceIsConsistentOver100Seeds) {
  Consistency sums;
  for (std::uint64_t seed = 1; seed <= kScanSeeds; ++seed)
    for (const Feature& feature : seen(kNowhere, 0.1, 2.0 * M_PI, {.constant = 0.01, .proportional = 0.005}, seed)) {
      if (feature.kind == FeatureKind::line && feature.half_length > 0.5) sums.add_line(feature);
      if (feature.kind == FeatureKind::corner) sums.add_corner(feature);
    }
  ASSERT_GT(sums.line_terms, 6 * kScanSeeds);
  ASSERT_GT(sums.corner_terms, 5 * kScanSeeds);
  EXPECT_NEAR(sums.lines / sums.line_terms, 1.0, 0.25);
  EXPECT_NEAR(sums.corners / sums.corner_terms, 1.0, 0.3);
}

TEST(ScanFeatures, EchoesOfConesLieOnTheirArc) {
  const base::Pose X_MC{0.1, 0.2, 0.0, 0.5 * M_PI};
  const Feature echo = cone_echo(X_MC, 2.0, 0.02, 0.5);
  EXPECT_EQ(echo.kind, FeatureKind::cluster);
  EXPECT_NEAR(echo.p.x, 0.1, 1e-9);
  EXPECT_NEAR(echo.p.y, 2.2, 0.03);
  EXPECT_NEAR(std::sqrt(echo.covariance[0]), 2.0 * std::sin(0.25) / std::sqrt(3.0), 1e-2) << "across";
  EXPECT_NEAR(std::sqrt(echo.covariance[3]), 0.02, 0.02) << "along";
}

TEST(ScanFeatures, TagsHaveTheFindersErrors) {
  const Feature tag = tag_at({0.0, 0.0, 0.0, 0.5}, 2.0, -0.5, 1.0, {0.01, 0.02, 0.03}, 7);
  EXPECT_NEAR(tag.p.x, 2.0, 1e-12);
  EXPECT_NEAR(tag.direction, 1.5, 1e-12);
  EXPECT_NEAR(tag.covariance[0], 1e-4, 1e-9);
  EXPECT_NEAR(tag.covariance[3], 16e-4, 2e-6);
  EXPECT_EQ(tag.id, 7u);
}

}  // namespace
}  // namespace sf::estimation
