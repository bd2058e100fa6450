// Rendered images: geometry, light, noise, and independence of anything but their arguments.

#include "vision/rendering/renderer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/vision/cameras.h"

namespace sf::vision {

namespace {

/// 160 x 120 pixels of 4 mm on the floor.
Camera small_camera() {
  Camera camera = plain_camera();
  camera.intrinsics = {160, 120, {250.0, 250.0}, {79.5, 59.5}, {}};
  camera.position = {0.0, 0.0, 1.0};
  return camera;
}

Imaging perfect() { return {255.0, 0.0, 0.0, 0.0, 0.0}; }

Scene bare(double floor) {
  Scene scene;
  scene.floor = floor;
  scene.texture = 0.0;
  return scene;
}

Patch patch_of(glm::dvec2 size, double albedo) {
  Patch patch;
  patch.size = size;
  patch.albedo = albedo;
  return patch;
}

Image rendered(const Camera& camera, const Imaging& imaging, const Scene& scene, std::uint32_t frame = 0) {
  Image image;
  Renderer(camera, imaging, 1).render(scene, 0.0, frame, image);
  return image;
}

double mean_of_row(const Image& image, int v) {
  double sum = 0.0;
  for (int u = 0; u < image.width; ++u) sum += *image.at(u, v);
  return sum / image.width;
}

}  // namespace

TEST(Renderer, PutsPatchesWhereTheCameraProjectsThem) {
  Scene scene = bare(0.2);
  Patch patch = patch_of({0.16, 0.08}, 0.8);
  patch.X_WP = {0.1, 0.04, 0.0, 0.0};
  scene.patches.push_back(patch);
  const Image image = rendered(small_camera(), perfect(), scene);
  // x from 0.02 to 0.18 m: columns 84.5 to 124.5. y from 0 to 0.08 m: rows 39.5 to 59.5.
  EXPECT_EQ(*image.at(84, 50), 51);
  EXPECT_EQ(*image.at(85, 50), 204);
  EXPECT_EQ(*image.at(124, 50), 204);
  EXPECT_EQ(*image.at(125, 50), 51);
  EXPECT_EQ(*image.at(100, 39), 51);
  EXPECT_EQ(*image.at(100, 40), 204);
  EXPECT_EQ(*image.at(100, 59), 204);
  EXPECT_EQ(*image.at(100, 60), 51);
}

TEST(Renderer, AveragesWithinAPixel) {
  Scene scene = bare(0.0);
  Patch patch = patch_of({1.0, 1.0}, 1.0);
  patch.X_WP = {0.5 + 0.001, 0.0, 0.0, 0.0};  // covers 3/4 of column 80, which begins at 0.000 m
  scene.patches.push_back(patch);
  const Image image = rendered(small_camera(), perfect(), scene);
  double sum = 0.0;
  for (int v = 10; v < 110; ++v) sum += *image.at(80, v);
  EXPECT_NEAR(sum / 100.0, 0.75 * 255.0, 1.0);
}

TEST(Renderer, HigherPatchesHideLowerOnes) {
  Scene scene = bare(0.0);
  Patch high = patch_of({0.1, 0.1}, 0.8), low = patch_of({0.4, 0.4}, 0.4);
  high.X_WP.z = 0.2;
  low.X_WP.z = 0.1;
  scene.patches = {high, low};
  const Image image = rendered(small_camera(), perfect(), scene);
  EXPECT_EQ(*image.at(80, 60), 204);
  EXPECT_EQ(*image.at(110, 60), 102);
  EXPECT_EQ(*image.at(150, 60), 0);
}

TEST(Renderer, LaterPatchesHideEarlierOnesOfTheirHeight) {
  Scene scene = bare(0.0);
  for (const double albedo : {0.2, 0.4, 0.6, 0.8})
    scene.patches.push_back(patch_of(glm::dvec2{0.5 - 0.5 * albedo}, albedo));
  const Image image = rendered(small_camera(), perfect(), scene);
  for (const auto& [u, grey] : {std::pair(80, 204), std::pair(95, 153), std::pair(110, 102), std::pair(125, 51)})
    EXPECT_EQ(*image.at(u, 60), grey) << u;
}

TEST(Renderer, PatchesBelowTheFloorAreSeen) {
  Scene scene = bare(0.5);
  scene.patches.push_back(patch_of({0.1, 0.1}, 0.2));
  scene.patches[0].X_WP.z = -0.02;  // the body under a tag on the floor
  EXPECT_EQ(*rendered(small_camera(), perfect(), scene).at(80, 60), 51);
}

TEST(Renderer, BlackPatchesHideTheFloor) {
  Scene scene = bare(0.5);
  scene.patches.push_back(patch_of({0.1, 0.1}, 0.0));
  EXPECT_EQ(*rendered(small_camera(), perfect(), scene).at(80, 60), 0);
}

TEST(Renderer, BlursMotionDuringTheExposure) {
  Camera camera = small_camera();
  camera.exposure = 0.01;
  Scene scene = bare(0.0);
  Patch patch = patch_of({0.08, 0.4}, 1.0);
  patch.velocity = {4.0, 0.0};  // 40 mm during the exposure: 10 px
  scene.patches.push_back(patch);
  const Image image = rendered(camera, perfect(), scene);
  // The left edge moves from -0.04 m to 0: columns 69.5 to 79.5; in the middle of its path, half of the light.
  double sum = 0.0;
  for (int v = 30; v < 90; ++v) sum += 0.5 * (*image.at(74, v) + *image.at(75, v));
  EXPECT_NEAR(sum / 60.0, 127.5, 3.0);
  EXPECT_EQ(*image.at(68, 60), 0);
  EXPECT_EQ(*image.at(84, 60), 255);
}

TEST(Renderer, ReadsRowsOneAfterAnother) {
  Camera camera = small_camera();
  camera.readout = 0.119;  // 1 ms a row
  Scene scene = bare(0.0);
  Patch patch = patch_of({0.2, 2.0}, 1.0);
  patch.velocity = {1.0, 0.0};  // a quarter pixel a row
  scene.patches.push_back(patch);
  const Image image = rendered(camera, perfect(), scene);
  const auto left_edge = [&](int v) {
    int u = 0;
    while (u < 160 && *image.at(u, v) < 128) ++u;
    return u;
  };
  EXPECT_EQ(left_edge(0), 55);  // -0.1 m
  EXPECT_NEAR(left_edge(100) - left_edge(0), 25, 1);
}

/// Rows share times where this displaces no patch by more than a hundredth of a pixel.
TEST(Renderer, RowsHaveTheirTimesToAHundredthOfAPixel) {
  Camera camera = small_camera();
  camera.readout = 0.119;
  for (const double speed : {0.02, 0.2, 2.0}) {  // 0.005, 0.05 and 0.5 px a row
    Scene scene = bare(0.0);
    Patch patch = patch_of({0.2, 2.0}, 1.0);
    patch.X_WP.x = 0.0005;  // the left edge is within a pixel
    patch.velocity = {speed, 0.0};
    scene.patches.push_back(patch);
    const Image image = rendered(camera, perfect(), scene);
    for (const int v : {0, 1, 2, 3, 4, 5, 6, 7}) {
      double dark = 0.0;  // [px] left of the edge
      for (int u = 0; u < 80; ++u) dark += 1.0 - *image.at(u, v) / 255.0;
      const double x = 0.0005 - 0.1 + speed * 0.001 * v;
      EXPECT_NEAR(dark, 79.5 + x / 0.004 + 0.5, 0.01 + 0.03) << speed << ' ' << v << ": 1 of 32 samples";
    }
  }
}

TEST(Renderer, NoiseHasTheStatedVariance) {
  Imaging imaging = perfect();
  imaging.read_noise = 2.0;
  imaging.shot_noise = 0.05;
  const Image image = rendered(small_camera(), imaging, bare(0.5));
  double sum = 0.0, squares = 0.0;
  for (const std::uint8_t grey : image.pixels) {
    sum += grey;
    squares += static_cast<double>(grey) * grey;
  }
  const double n = static_cast<double>(image.pixels.size()), mean = sum / n, variance = squares / n - mean * mean;
  EXPECT_NEAR(mean, 127.5, 5.0 * 3.3 / std::sqrt(n));
  // Read noise, shot noise, quantisation. The standard error of a variance is sqrt(2/n) times the variance.
  const double expected = 4.0 + 0.05 * 127.5 + 1.0 / 12.0;
  EXPECT_NEAR(variance, expected, 5.0 * std::sqrt(2.0 / n) * expected);
}

TEST(Renderer, CornersAreDarkerByVignetting) {
  Imaging imaging = perfect();
  imaging.vignetting = 0.4;
  const Image image = rendered(small_camera(), imaging, bare(1.0));
  EXPECT_NEAR(*image.at(0, 0), 0.6 * 255.0, 1.0);
  EXPECT_NEAR(*image.at(80, 60), 255.0, 1.0);
}

TEST(Renderer, LightIsAGradient) {
  Scene scene = bare(0.5);
  scene.gradient = {0.0, 1.0};
  const Image image = rendered(small_camera(), perfect(), scene);
  EXPECT_NEAR(mean_of_row(image, 9), 127.5 * (1.0 + 50.5 * 0.004), 1.0);  // 50.5 rows above the centre
}

TEST(Renderer, ImagesAreAFunctionOfTheirArguments) {
  const Scene scene = bare(0.5);
  Renderer renderer(small_camera(), Imaging{}, 1);
  Image first, second, again;
  renderer.render(scene, 0.0, 0, first);
  renderer.render(scene, 0.0, 1, second);
  renderer.render(scene, 0.0, 0, again);
  EXPECT_EQ(first.pixels, again.pixels);
  EXPECT_NE(first.pixels, second.pixels);  // another frame
  Camera other = small_camera();
  other.name = "other";
  EXPECT_NE(rendered(other, Imaging{}, scene).pixels, first.pixels);  // another camera
  EXPECT_EQ(rendered(small_camera(), Imaging{}, scene).pixels, first.pixels);
}

}  // namespace sf::vision
