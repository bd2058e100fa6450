// Computes camera poses from rendered images of surveyed tags.

#include "vision/placement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/refusal.h"
#include "tests/vision/cameras.h"
#include "tests/vision/images_in_memory.h"
#include "vision/rendering/renderer.h"
#include "vision/testbed_patches.h"

namespace sf::vision {

namespace {

Camera truth() {
  Camera camera = distorted_camera();
  camera.intrinsics = {640, 512, {832.0, 832.0}, {322.0, 254.0}, {-0.18, 0.06, 0.0005, -0.0004, 0.0}};
  camera.position = {0.4, -0.3, 4.0};
  camera.exposure = camera.readout = 0.0;
  return camera;
}

/// Tags 1 to 5 at different heights; the fifth is not visible.
Testbed survey(bool headings) {
  Testbed testbed;
  testbed.file = "lab.toml";
  testbed.dictionary = "aruco_4x4_50";
  testbed.tag.side = 0.15;
  testbed.cameras.push_back({truth(), ""});
  const std::array<glm::dvec3, 5> places{
      {{-0.6, -1.0, 0.0}, {1.3, -0.9, 0.3}, {1.2, 0.5, 0.0}, {-0.5, 0.4, 0.2}, {9.0, 0.0, 0.0}}};
  for (std::uint32_t id = 1; id <= places.size(); ++id)
    testbed.surveyed[id] = {places[id - 1], headings ? std::optional(0.5 * id) : std::nullopt};
  return testbed;
}

ImagesInMemory pictures(const Testbed& testbed, std::size_t tags = 5) {
  Scene scene;
  for (const auto& [id, tag] : testbed.surveyed)
    if (id <= tags)
      add_tag(scene, {id, {tag.position.x, tag.position.y, tag.position.z, 0.5 * id}, {}, 0.0}, 0.0,
              testbed.mount(id).side, opencv().tag_pattern(testbed.dictionary, id));
  std::vector<Image> images(2);
  Renderer renderer(truth(), Imaging{}, 1);
  for (std::uint32_t i = 0; i < images.size(); ++i) renderer.render(scene, 0.0, i, images[i]);
  images.emplace_back();  // an unreadable file
  return ImagesInMemory(std::move(images));
}

Camera unplaced() {
  Camera camera = truth();
  camera.position = {0.0, 0.0, 0.0};
  set_orientation(camera, {1.0, 0.0, 0.0, 0.0});
  return camera;
}

std::string refusal(const Testbed& testbed, ImagesInMemory images) {
  return refusal_of([&] { place_camera(testbed, unplaced(), images, "album"); });
}

}  // namespace

TEST(Placement, FindsTheCameraFromSurveyedTags) {
  for (const bool headings : {true, false}) {
    const Testbed testbed = survey(headings);
    ImagesInMemory images = pictures(testbed);
    const Placement found = place_camera(testbed, unplaced(), images, "album");
    EXPECT_LT(found.residual, 0.1);
    // Four points alone hardly tell a tilt from a displacement: 4.3 mm RMS over 24 turns of the tags, at most 10.3.
    EXPECT_LT(glm::distance(found.camera.position, truth().position), headings ? 0.005 : 0.015);
    EXPECT_GT(glm::dot(found.camera.forward, truth().forward), std::cos(headings ? 0.001 : 0.004));
    EXPECT_GT(glm::dot(found.camera.right, truth().right), std::cos(headings ? 0.001 : 0.004));
    ASSERT_EQ(found.tags.size(), 4u);
    EXPECT_EQ(found.tags[0].images, 2u);
    EXPECT_LT(found.tags[3].metres, 0.001);
    EXPECT_EQ(found.unseen, std::vector<std::uint32_t>{5});
  }
}

TEST(Placement, AWrongPositionShowsInItsResidual) {
  Testbed testbed = survey(true);
  ImagesInMemory images = pictures(testbed);
  testbed.surveyed[2].position.x += 0.10;
  const Placement found = place_camera(testbed, unplaced(), images, "album");
  EXPECT_GT(found.residual, 3.0);
  for (const TagResidual& tag : found.tags) ASSERT_TRUE(tag.without);
  EXPECT_LT(*found.tags[1].without, 0.1);
  for (const std::size_t other : {0u, 2u, 3u}) EXPECT_GT(*found.tags[other].without, 1.0);
}

/// Each tag has four corners, so the mean of the tags' squares equals that of all corners.
TEST(Placement, ResidualsOfTagsCombineToTheTotal) {
  Testbed testbed = survey(true);
  ImagesInMemory images = pictures(testbed);
  testbed.surveyed[2].position.x += 0.10;
  const Placement found = place_camera(testbed, unplaced(), images, "album");
  double squares = 0.0;
  for (const TagResidual& tag : found.tags) squares += tag.pixels * tag.pixels;
  EXPECT_NEAR(std::sqrt(squares / 4.0), found.residual, 1e-3);
}

/// Only 200 images of a folder are read: a later one of another size is ignored.
TEST(Placement, ReadsTwoHundredImages) {
  const Testbed testbed = survey(false);
  for (const std::size_t before : {199u, 200u}) {
    std::vector<Image> images(before);
    images.push_back({64, 48, 1, std::vector<std::uint8_t>(64 * 48, 9)});
    const std::string error = refusal(testbed, ImagesInMemory(std::move(images)));
    EXPECT_EQ(error.find("image 200 is 64 x 48") != std::string::npos, before == 199) << error;
    EXPECT_EQ(error.find("saw 0, with 0 points") != std::string::npos, before == 200) << error;
  }
}

/// Boundaries: no survey, no image, one point too few, points on a line; the minimum that suffices.
TEST(Placement, ReportsMissingInput) {
  Testbed testbed = survey(false);
  EXPECT_EQ(refusal(testbed, ImagesInMemory({})),
            "album: of the 5 surveyed tags of lab.toml, camera 'distorted' saw 0, with 0 points: too few; expected "
            "four points that are not on one line: four tags, or one whose [[survey]] section has a heading. Not seen: "
            "1, 2, 3, 4, 5");
  EXPECT_NE(refusal(testbed, pictures(testbed, 3)).find("saw 3 (1, 2, 3), with 3 points: too few"), std::string::npos);
  EXPECT_NE(
      refusal(testbed, ImagesInMemory({Image{64, 48, 1, std::vector<std::uint8_t>(64 * 48, 9)}})).find("is 64 x 48"),
      std::string::npos);
  EXPECT_EQ(refusal(survey(true), pictures(survey(true), 1)), "");
  Testbed line = testbed;
  for (auto& [id, tag] : line.surveyed) tag.position = {0.7 * id - 1.5, 0.1 * id, 0.0};
  EXPECT_NE(refusal(line, pictures(line)).find("nearly on one line"), std::string::npos);
  testbed.surveyed.clear();
  EXPECT_NE(refusal(testbed, ImagesInMemory({})).find("lab.toml: has no surveyed tags"), std::string::npos);
}

}  // namespace sf::vision
