// Families of tags and their orientation.

#include "vision/tag_family.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/refusal.h"
#include "tests/units.h"
#include "tests/vision/cameras.h"
#include "vision/bch_code.h"
#include "vision/rendering/renderer.h"
#include "vision/tag_detector.h"

namespace sf::vision {

namespace {

/// Returns the cells inside of the border, row by row, the upper left one in the highest bit.
std::uint64_t code_of(const TagPattern& pattern) {
  std::uint64_t code = 0;
  for (int row = 1; row + 1 < pattern.cells; ++row)
    for (int column = 1; column + 1 < pattern.cells; ++column)
      code = code << 1 | pattern.white[static_cast<std::size_t>(pattern.cells * row + column)];
  return code;
}

/// A marker with a black border of `border` cells.
TagPattern bordered(BchWord cells, int border) {
  const int n = kBchCells + 2 * border;
  TagPattern pattern{n, std::vector<std::uint8_t>(static_cast<std::size_t>(n * n), 0)};
  for (int i = 0; i < kBchCells * kBchCells; ++i)
    pattern.white[static_cast<std::size_t>(n * (border + i / kBchCells) + border + i % kBchCells)] =
        cells >> (35 - i) & 1;
  return pattern;
}

struct Seen {
  std::vector<Sighting> tags;
  DetectionCounts counts;
};

/// Renders one tag 3 m below a camera and detects it.
Seen see(const std::string& family, const TagPattern& pattern, double yaw) {
  Testbed testbed;
  testbed.file = "t.toml";
  testbed.dictionary = family;
  Camera camera = plain_camera();
  camera.intrinsics.width = 320, camera.intrinsics.height = 256, camera.intrinsics.center = {159.5, 127.5};
  camera.position.z = 3.0;
  testbed.cameras.push_back({camera, ""});
  Scene scene;
  Patch tag;
  tag.shape = Patch::Shape::tag;
  tag.X_WP = {0.05, -0.03, 0.0, yaw};
  tag.size = {0.15, 0.15};
  tag.pattern = pattern;
  scene.patches.push_back(tag);
  Image image;
  Renderer(camera, Imaging{}, 1).render(scene, 0.0, 0, image);
  Seen seen;
  TagDetector detector(testbed, camera);
  detector.detect(image, 0.0, seen.tags);
  seen.counts = detector.counts();
  return seen;
}

}  // namespace

/// Cells of the images of libapriltag 3.3.0 (apriltag_to_image), whose detector places the tag's frame upright in them.
TEST(TagFamilies, AprilTagsAreUprightAsInLibapriltag) {
  struct Fact {
    std::string family;
    std::uint64_t first, second;  ///< of ids 0 and 1
  };
  for (const Fact& fact :
       {Fact{"apriltag_16h5", 0x231B, 0x2EA5}, Fact{"apriltag_25h9", 0x155CBF1, 0x1E4D1B6},
        Fact{"apriltag_36h10", 0x1CA92A687, 0x20521AC4C}, Fact{"apriltag_36h11", 0xD5D628584, 0xD97F18B49}}) {
    EXPECT_EQ(code_of(family_pattern(fact.family, 0)), fact.first) << fact.family;
    EXPECT_EQ(code_of(family_pattern(fact.family, 1)), fact.second) << fact.family;
    TagPattern printed = family_pattern(fact.family, 1);
    std::reverse(printed.white.begin(), printed.white.end());
    EXPECT_EQ(family_pattern(fact.family + "_opencv", 1).white, printed.white) << fact.family;
    EXPECT_NE(family_orientation(fact.family).find("OpenCV"), std::string::npos);
  }
  EXPECT_EQ(family_orientation("aruco_4x4_50"), "");
}

TEST(TagFamilies, AprilTagsReadUprightOrAsOpenCvPrintsThem) {
  const TagPattern tag = family_pattern("apriltag_36h11", 5);
  for (const auto& [family, yaw] : {std::pair{"apriltag_36h11", 0.4}, {"apriltag_36h11_opencv", 0.4 - M_PI}}) {
    const Seen seen = see(family, tag, 0.4);
    ASSERT_EQ(seen.tags.size(), 1u) << family;
    EXPECT_EQ(seen.tags[0].id, 5u);
    EXPECT_NEAR(base::wrap_angle(seen.tags[0].fit.X_WT.yaw - yaw), 0.0, 0.3 * kDegree) << family;
  }
}

TEST(TagFamilies, UnknownNamesListTheKnownOnes) {
  for (const char* name : {"apriltag_36h12", "aruco_4x4_50_opencv", "artoolkitplus", ""}) {
    const std::string text = refusal_of([&] { make_family_finder(name); });
    EXPECT_NE(text.find("apriltag_36h11"), std::string::npos) << text;
  }
  EXPECT_NE(refusal_of([] { family_size("bch"); }).find("artoolkitplus_bch"), std::string::npos);
}

TEST(BchMarkers, HaveFourThousandNinetySixIds) {
  EXPECT_EQ(family_size("artoolkitplus_bch"), 4096u);
  EXPECT_EQ(code_of(family_pattern("artoolkitplus_bch", 4095)), 0x70759F1F6u);
  EXPECT_THROW(family_pattern("artoolkitplus_bch", 4096), base::InputError);
}

/// ARToolKitPlus's images have a border of one cell ("thin"), its generator by default one of three.
TEST(BchMarkers, AreReadWithEitherBorderInAnyOrientation) {
  for (const int border : {1, 3})
    for (const double yaw : {0.1, 1.7, 3.1, -1.4}) {
      const Seen seen = see("artoolkitplus_bch", bordered(encode_bch(1234), border), yaw);
      ASSERT_EQ(seen.tags.size(), 1u) << border << " " << yaw;
      EXPECT_EQ(seen.tags[0].id, 1234u);
      EXPECT_EQ(seen.counts.unfitted, 0u) << "the inner edge of the border";
      EXPECT_NEAR(base::wrap_angle(seen.tags[0].fit.X_WT.yaw - yaw), 0.0, 0.3 * kDegree);
      EXPECT_NEAR(seen.tags[0].fit.X_WT.x, 0.05, 1e-3);
    }
}

/// Boundary: four wrong cells are corrected, five are not.
TEST(BchMarkers, AreReadWithFourWrongCells) {
  const BchWord four = encode_bch(77) ^ 0x108000021;
  const Seen seen = see("artoolkitplus_bch", bordered(four, 1), 0.3);
  ASSERT_EQ(seen.tags.size(), 1u);
  EXPECT_EQ(seen.tags[0].id, 77u);
  EXPECT_TRUE(see("artoolkitplus_bch", bordered(four ^ 0x400000, 1), 0.3).tags.empty());
}

TEST(BchMarkers, SquaresWithoutACodeAreNone) {
  EXPECT_TRUE(see("artoolkitplus_bch", bordered(0, 1), 0.3).tags.empty());
  EXPECT_TRUE(see("artoolkitplus_bch", bordered((BchWord{1} << 36) - 1, 1), 0.3).tags.empty());
}

}  // namespace sf::vision
