// Height and tilt of tags, measured from their edges.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "tests/instrumented.h"
#include "tests/units.h"
#include "tests/vision/cameras.h"
#include "vision/accuracy.h"
#include "vision/positioning.h"
#include "vision/rendering/renderer.h"
#include "vision/tag_family.h"

namespace sf::vision {

namespace {

constexpr double kSide = 0.15;

/// Returns the camera turned by `angle` about the axis `axis` through `pivot`.
Camera turned(Camera camera, glm::dvec3 pivot, glm::dvec3 axis, double angle) {
  const auto turn = [&](glm::dvec3 v) {
    return std::cos(angle) * v + std::sin(angle) * glm::cross(axis, v) +
           (1.0 - std::cos(angle)) * glm::dot(axis, v) * axis;
  };
  camera.position = pivot + turn(camera.position - pivot);
  camera.right = turn(camera.right);
  camera.down = turn(camera.down);
  camera.forward = turn(camera.forward);
  return camera;
}

/// Edge points of a tag, as a camera sees them, with noise of `sigma` [px].
std::vector<EdgePoint> edges(const Camera& camera, glm::dvec3 center, const std::array<glm::dvec3, 2>& axes,
                             double sigma, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<EdgePoint> points;
  for (int side = 0; side < 4; ++side)
    for (int i = -12; i <= 12; ++i) {
      const glm::dvec2 p = base::rotate(-0.5 * M_PI * side, {0.004 * i, 0.5 * kSide});
      const auto pixel = project(camera, center + p.x * axes[0] + p.y * axes[1]);
      points.push_back({*pixel + glm::dvec2{noise(random), noise(random)}, side});
    }
  return points;
}

Testbed testbed_of(const Camera& camera, TagFreedom fit) {
  Testbed testbed;
  testbed.file = "t.toml";
  testbed.tag.height = 0.2;
  testbed.tag.fit = fit;
  testbed.cameras.push_back({camera, ""});
  return testbed;
}

}  // namespace

/// Without noise, height and position are exact, also off the camera's axis and with a wrong given height.
TEST(MeasuredHeight, IsExactWithoutNoise) {
  const Camera camera = distorted_camera();
  for (const double z : {-0.3, 0.0, 0.2, 0.9}) {
    const auto points = edges(camera, {1.2, -0.7, z}, {glm::dvec3{0.0, 1.0, 0.0}, {-1.0, 0.0, 0.0}}, 0.0, 1);
    const auto flat = fit_tag(camera, points, 0.2);
    ASSERT_TRUE(flat);
    const TagFit fit = at_measured_height(camera, *flat, kSide);
    EXPECT_NEAR(fit.X_WT.z, z, 1e-8);
    EXPECT_NEAR(fit.X_WT.x, 1.2, 1e-8);
    EXPECT_NEAR(fit.X_WT.y, -0.7, 1e-8);
    EXPECT_NEAR(fit.X_WT.yaw, M_PI / 2.0, 1e-8);
    EXPECT_GT(fit.height_sigma, 0.0) << "the edges' bias";
  }
}

/// Tags whose heights the testbed file states wrongly by up to 0.5 m, in rendered images.
TEST(MeasuredHeight, MatchesTheTruthOfRenderedImages) {
  for (const double from : {6.5, 3.0}) {
    if (from > 6.0 && instrumented()) continue;
    Camera camera = distorted_camera();
    camera.position.z = from;
    Testbed truth = testbed_of(camera, TagFreedom::height);
    const std::array<double, 6> heights{0.0, 0.1, 0.2, 0.35, 0.5, 0.7};
    for (std::uint32_t id = 1; id <= heights.size(); ++id) {
      truth.tags[id] = truth.tag;
      truth.tags[id].height = heights[id - 1];
    }
    const RenderedFleet fleet(truth, {heights.size(), 0.0, 0, false, 1});
    std::vector<Frame> frames(1);
    Renderer(camera, Imaging{}, 1).render(fleet.scene_at(0.0), 0.0, 0, frames[0].image);
    const Testbed stated = testbed_of(camera, TagFreedom::height);
    Positioning positioning(stated);
    const auto tags = positioning.update(frames);
    ASSERT_EQ(tags.size(), heights.size());
    double squares = 0.0;
    for (std::size_t i = 0; i < tags.size(); ++i) {
      const TrueTag tag = fleet.truth(i, tags[i].time);
      const double error = tags[i].X_WT.z - tag.X_WT.z;
      EXPECT_LT(std::abs(error), from > 6.0 ? 30e-3 : 8e-3) << tags[i].id;
      EXPECT_NEAR(tags[i].X_WT.x, tag.X_WT.x, from > 6.0 ? 12e-3 : 4e-3);
      EXPECT_NEAR(tags[i].X_WT.y, tag.X_WT.y, from > 6.0 ? 12e-3 : 4e-3);
      EXPECT_LT(tags[i].height_sigma, from > 6.0 ? 15e-3 : 5e-3);
      squares += std::pow(error / tags[i].height_sigma, 2);
    }
    EXPECT_LT(std::sqrt(squares / 6.0), 2.0) << "the stated uncertainty is too small";
  }
}

/// Boundary: a measured height more than 1 m from the stated one is rejected.
TEST(MeasuredHeight, IsWithinAMetreOfTheStatedOne) {
  const Camera camera = plain_camera();
  Scene scene;
  Patch tag;
  tag.shape = Patch::Shape::tag;
  tag.X_WP = {0.3, 0.2, 0.2, 0.5};
  tag.size = {kSide, kSide};
  tag.pattern = family_pattern("apriltag_36h11", 3);
  scene.patches.push_back(tag);
  Image image;
  Renderer(camera, Imaging{}, 1).render(scene, 0.0, 0, image);
  for (const auto& [stated, count] : {std::pair{-0.7, 1u}, {1.1, 1u}, {-0.9, 0u}, {1.3, 0u}}) {
    Testbed testbed = testbed_of(camera, TagFreedom::height);
    testbed.tag.height = stated;
    TagDetector detector(testbed, camera);
    std::vector<Sighting> seen;
    detector.detect(image, 0.0, seen);
    EXPECT_EQ(seen.size(), count) << stated;
    EXPECT_EQ(detector.counts().misfitted, 1u - count) << stated;
  }
}

/// A horizontal tag seen by a turned camera is a tilted tag in the turned camera's world.
TEST(MeasuredTilt, MatchesTheTruthOfRenderedImages) {
  Camera above = plain_camera();
  above.intrinsics.width = 640, above.intrinsics.height = 512, above.intrinsics.center = {319.5, 255.5};
  above.position = {0.0, 0.0, 2.0};
  const glm::dvec3 center{0.1, -0.05, 0.2}, up{0.0, 0.0, 1.0}, along{1.0, 0.0, 0.0};
  Scene scene;
  Patch tag;
  tag.shape = Patch::Shape::tag;
  tag.X_WP = {center.x, center.y, center.z, 0.4};
  tag.size = {kSide, kSide};
  tag.pattern = family_pattern("apriltag_36h11", 3);
  scene.patches.push_back(tag);
  for (const double oblique : {0.0, 20.0, -40.0}) {
    const Camera camera = turned(above, center, glm::dvec3{0.6, 0.8, 0.0}, oblique * kDegree);
    Image image;
    Renderer(camera, Imaging{}, 1).render(scene, 0.0, 0, image);
    for (const double tilt : {0.0, 10.0, -20.0}) {
      const Camera viewer = turned(camera, center, along, tilt * kDegree);
      std::vector<Sighting> seen;
      TagDetector(testbed_of(viewer, TagFreedom::tilt), viewer).detect(image, 0.0, seen);
      ASSERT_EQ(seen.size(), 1u) << oblique << " " << tilt;
      const TagFit& fit = seen[0].fit;
      EXPECT_NEAR(fit.X_WT.x, center.x, 3e-3);
      EXPECT_NEAR(fit.X_WT.y, center.y, 3e-3);
      EXPECT_NEAR(fit.X_WT.z, center.z, 3.0 * fit.height_sigma);
      // The normal of the measured tag, and the vertical that was turned with the camera.
      const glm::dvec2 flat =
          base::rotate(fit.X_WT.yaw, {std::sin(fit.pitch) * std::cos(fit.roll), -std::sin(fit.roll)});
      const glm::dvec3 normal{flat.x, flat.y, std::cos(fit.pitch) * std::cos(fit.roll)};
      const glm::dvec3 truth = std::cos(tilt * kDegree) * up + std::sin(tilt * kDegree) * glm::cross(along, up);
      const double error = std::acos(std::min(1.0, glm::dot(normal, truth)));
      EXPECT_LT(error, 3.0 * fit.tilt_sigma) << oblique << " " << tilt;
      EXPECT_LT(error, 1.5 * kDegree) << oblique << " " << tilt;
    }
  }
}

/// Normalised errors of 200 tags with independent noise of the edges: the stated deviations are not too small.
TEST(MeasuredTilt, StatesItsUncertainty) {
  Camera camera = plain_camera();
  camera.position.z = 3.0;
  double heights = 0.0, tilts = 0.0;
  constexpr int kTrials = 200;
  for (int i = 0; i < kTrials; ++i) {
    const double a = 0.4 * std::sin(0.7 * i), b = 0.4 * std::cos(1.1 * i), x = std::sin(1.3 * i), y = 0.7 * std::cos(i);
    const glm::dvec3 ex = glm::normalize(glm::dvec3{1.0, 0.0, a});
    const glm::dvec3 ey = glm::normalize(glm::dvec3{0.0, 1.0, b} - glm::dot(glm::dvec3{0.0, 1.0, b}, ex) * ex);
    const auto points = edges(camera, {x, y, 0.3}, {ex, ey}, 0.05, static_cast<std::uint64_t>(i));
    const auto flat = fit_tag(camera, points, 0.3);
    ASSERT_TRUE(flat);
    const auto fit = fit_tag_in_space(camera, points, *flat, kSide);
    ASSERT_TRUE(fit);
    const glm::dvec3 normal = glm::cross(ex, ey);
    const double pitch = -std::asin(ex.z), roll = std::atan2(ey.z, normal.z);
    heights += std::pow((fit->X_WT.z - 0.3) / fit->height_sigma, 2);
    const double off = std::hypot(fit->pitch - pitch, fit->roll - roll) / fit->tilt_sigma;
    tilts += 0.5 * off * off;
  }
  EXPECT_LT(std::sqrt(heights / kTrials), 1.2);
  EXPECT_LT(std::sqrt(tilts / kTrials), 1.2);
}

}  // namespace sf::vision
