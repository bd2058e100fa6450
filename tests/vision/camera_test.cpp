// The camera model: projection, distortion, back-projection.

#include "vision/camera.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/vision/cameras.h"

namespace sf::vision {

TEST(Camera, LooksStraightDownByDefault) {
  // 1 px at the centre is height / focal: 6.5 m / 1664 px on the floor; the image's right is +x, its top is +y.
  Camera camera = plain_camera();
  const auto center = project(camera, {0.0, 0.0, 0.0});
  ASSERT_TRUE(center);
  EXPECT_EQ(center->x, 639.5);
  EXPECT_EQ(center->y, 511.5);
  const auto p = project(camera, {1.0, 0.5, 0.0});
  EXPECT_NEAR(p->x, 639.5 + 1664.0 / 6.5, 1e-9);
  EXPECT_NEAR(p->y, 511.5 - 0.5 * 1664.0 / 6.5, 1e-9);
}

TEST(Camera, DistortsByBrownsFormula) {
  // Computed by hand: n = (0.3, -0.2), r2 = 0.13.
  Intrinsics i{1280, 1024, {1000.0, 1100.0}, {600.0, 500.0}, {-0.2, 0.05, 0.001, -0.002, 0.01}};
  const double radial = 1.0 - 0.2 * 0.13 + 0.05 * 0.0169 + 0.01 * 0.002197;
  const double x = 0.3 * radial + 2.0 * 0.001 * 0.3 * -0.2 - 0.002 * (0.13 + 2.0 * 0.09);
  const double y = -0.2 * radial + 0.001 * (0.13 + 2.0 * 0.04) + 2.0 * -0.002 * 0.3 * -0.2;
  const glm::dvec2 pixel = distort(i, {0.3, -0.2});
  EXPECT_NEAR(pixel.x, 600.0 + 1000.0 * x, 1e-9);
  EXPECT_NEAR(pixel.y, 500.0 + 1100.0 * y, 1e-9);
}

RC_GTEST_PROP(Camera, BackProjectionInvertsProjection, ()) {
  Camera camera = distorted_camera();
  const double roll = *rc::gen::inRange(-200, 200) * 1e-3;
  set_orientation(camera, {std::cos(roll), std::sin(roll), 0.0, 0.0});
  const glm::dvec2 pixel{static_cast<double>(*rc::gen::inRange(0, 1280)),
                         static_cast<double>(*rc::gen::inRange(0, 1024))};
  const double height = *rc::gen::inRange(-100, 300) * 1e-2;
  const auto p = to_plane(camera, pixel, height);
  RC_ASSERT(p.has_value());
  const auto back = project(camera, {p->x, p->y, height});
  RC_ASSERT(back.has_value());
  RC_ASSERT(glm::distance(*back, pixel) < 1e-8);
}

RC_GTEST_PROP(Camera, OrientationIsReadBack, ()) {
  std::array<double, 4> q{};
  double norm = 0.0;
  for (double& component : q) {
    component = *rc::gen::inRange(-1000, 1001);
    norm += component * component;
  }
  RC_PRE(norm > 0.0);
  for (double& component : q) component /= std::sqrt(norm);
  Camera camera;
  set_orientation(camera, q);
  const auto back = orientation(camera);
  double dot = 0.0;  // q and -q are the same rotation
  for (std::size_t i = 0; i < 4; ++i) dot += q[i] * back[i];
  RC_ASSERT(std::abs(std::abs(dot) - 1.0) < 1e-12);
  RC_ASSERT(glm::distance(glm::cross(camera.right, camera.down), camera.forward) < 1e-12);
}

/// Newton's method needs all derivatives if a lens distorts as much tangentially as radially.
TEST(Camera, UndistortsStrongTangentialDistortion) {
  Intrinsics i = plain_camera().intrinsics;
  for (const auto& [down, across] : {std::pair{0.3, 0.0}, {0.0, 0.3}, {-0.3, 0.0}, {0.0, -0.3}}) {
    i.distortion = {0.0, 0.0, down, across, 0.0};
    const double far = 0.5 * (down + across < 0.0 ? -1.0 : 1.0);
    for (const glm::dvec2& n : {glm::dvec2{far, -0.5 * far}, glm::dvec2{-0.5 * far, far}, glm::dvec2{far, far}})
      EXPECT_LT(glm::distance(undistort(i, distort(i, n)), n), 1e-12)
          << down << " " << across << ": " << n.x << " " << n.y;
  }
}

TEST(Camera, RejectsInvisiblePoints) {
  const Camera camera = distorted_camera();
  EXPECT_FALSE(project(camera, {0.0, 0.0, 6.5}));       // its own position
  EXPECT_FALSE(project(camera, {0.0, 0.0, 7.0}));       // behind it
  EXPECT_FALSE(project(camera, {50.0, 0.0, 0.0}));      // 83 degrees off the axis
  EXPECT_FALSE(to_plane(camera, {600.0, 500.0}, 6.5));  // plane through the camera
  EXPECT_FALSE(to_plane(camera, {600.0, 500.0}, 8.0));  // plane above it
  Camera folded = plain_camera();
  folded.intrinsics.distortion = {-0.15, 0.0, 0.0, 0.0, 0.0};
  EXPECT_TRUE(is_invertible(folded.intrinsics));
  EXPECT_FALSE(project(folded, {16.0, 0.0, 0.0}));  // the polynomial folds back into the image: 2.46 (1 - 0.15 2.46^2)
  Camera level = plain_camera();
  level.forward = {1.0, 0.0, 0.0};
  level.right = {0.0, -1.0, 0.0};
  level.down = {0.0, 0.0, -1.0};
  EXPECT_FALSE(to_plane(level, {639.5, 511.5}, 0.0));  // along the horizon
  EXPECT_FALSE(to_plane(level, {639.5, 400.0}, 0.0));  // above it
  EXPECT_TRUE(to_plane(level, {639.5, 600.0}, 0.0));
}

TEST(Camera, DetectsLensesThatFold) {
  Intrinsics i = distorted_camera().intrinsics;
  EXPECT_TRUE(is_invertible(i));
  i.distortion = {-2.5, 0.0, 0.0, 0.0, 0.0};  // r (1 - 2.5 r2) is largest at r = 0.365, and the corner is at 0.49
  EXPECT_FALSE(is_invertible(i));
  i.distortion = {0.0, 0.0, 0.0, 0.5, 0.0};  // tangential only
  EXPECT_FALSE(is_invertible(i));
}

TEST(Camera, TimesRows) {
  Camera camera = plain_camera();
  EXPECT_EQ(middle_of_exposure(camera, 700.0), 0.0);
  camera.exposure = 0.004;
  camera.readout = 0.02;
  EXPECT_NEAR(middle_of_exposure(camera, 0.0), 0.002, 1e-15);
  EXPECT_NEAR(middle_of_exposure(camera, 1023.0), 0.022, 1e-15);
}

TEST(Camera, NamesAreKeysAndStems) {
  for (const char* name : {"north", "N", "7", "a_b-c", "2nd"}) EXPECT_TRUE(is_camera_name(name)) << name;
  EXPECT_TRUE(is_camera_name(std::string(64, 'a')));
  EXPECT_FALSE(is_camera_name(std::string(65, 'a')));  // longer than a file name needs
  for (const std::string& name :
       std::vector<std::string>{"", "..", "a/b", "../a",     // other folders
                                "a=b", "a b", "-a", "a\"b",  // other arguments or tokens of the file
                                "_a", "a.b", "a\n", "\xC3\xB6", std::string("a\0b", 3)})
    EXPECT_FALSE(is_camera_name(name)) << name;
}

}  // namespace sf::vision
