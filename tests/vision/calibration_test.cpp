// Calibrates intrinsics from rendered images of a chessboard, and compares them with those used for rendering.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/refusal.h"
#include "tests/vision/cameras.h"
#include "tests/vision/images_in_memory.h"
#include "vision/calibration.h"
#include "vision/rendered_fleet.h"
#include "vision/rendering/renderer.h"

namespace sf::vision {

namespace {

constexpr int kSquares = 10;
constexpr double kSquare = 0.05;  // [m]

Camera camera_at(glm::dvec3 position, double roll, double pitch) {
  Camera camera = distorted_camera();
  camera.intrinsics = {640, 480, {620.0, 610.0}, {325.0, 236.0}, {-0.2, 0.05, 0.0004, -0.0003, 0.0}};
  camera.exposure = camera.readout = 0.0;
  camera.position = position;
  // Looks at the board's centre, rotated by `roll` about its axis and tilted by `pitch`.
  camera.forward = glm::normalize(glm::dvec3{std::sin(pitch), 0.0, 0.0} - position);
  const glm::dvec3 side = glm::normalize(glm::cross(camera.forward, glm::dvec3{std::sin(roll), std::cos(roll), 0.0}));
  camera.right = side;
  camera.down = glm::cross(camera.forward, side);
  return camera;
}

Scene chessboard() {
  Scene scene;
  scene.texture = 0.0;
  Patch board;
  board.shape = Patch::Shape::tag;
  board.size = glm::dvec2{kSquares * kSquare};
  board.pattern.cells = kSquares;
  for (int i = 0; i < kSquares * kSquares; ++i)
    board.pattern.white.push_back(static_cast<std::uint8_t>((i / kSquares + i % kSquares) % 2));
  scene.patches.push_back(board);
  return scene;
}

constexpr Chessboard kBoard{kSquares - 1, kSquares - 1, kSquare};

constexpr int kTagSquares = 8,
              kCells = 8;  // squares along a side; cells of a square, of which a tag has the middle six
const Chessboard kBoardWithTags{kTagSquares - 1, kTagSquares - 1, 0.08, "aruco_4x4_50", 0.06};

/// A board larger than the images.
Scene board_with_tags() {
  Scene scene;
  scene.texture = 0.0;
  Patch board;
  board.shape = Patch::Shape::tag;
  board.size = glm::dvec2{kTagSquares * kBoardWithTags.square};
  const int cells = kTagSquares * kCells;
  board.pattern = {cells, std::vector<std::uint8_t>(static_cast<std::size_t>(cells * cells), 0)};
  std::uint32_t id = 0;
  for (int row = 0; row < kTagSquares; ++row)
    for (int column = 0; column < kTagSquares; ++column) {
      if ((row + column) % 2 == 0) continue;
      const TagPattern tag = opencv().tag_pattern(kBoardWithTags.dictionary, id++);
      for (int j = 0; j < kCells; ++j)
        for (int i = 0; i < kCells; ++i) {
          const bool inside = i > 0 && j > 0 && i < kCells - 1 && j < kCells - 1;
          board.pattern.white[static_cast<std::size_t>((row * kCells + j) * cells + column * kCells + i)] =
              inside ? tag.white[static_cast<std::size_t>((j - 1) * tag.cells + i - 1)] : std::uint8_t{1};
        }
    }
  scene.patches.push_back(board);
  return scene;
}

/// Six views of a board from about `height` [m].
std::vector<Image> rendered(const Scene& board, double height) {
  std::vector<Image> images(6);
  const glm::dvec3 positions[] = {{0.0, 0.0, 0.03}, {0.35, 0.1, 0.0}, {-0.35, 0.15, 0.0},
                                  {0.1, -0.4, 0.0}, {-0.1, 0.4, 0.0}, {0.3, 0.3, 0.07}};
  for (std::size_t i = 0; i < images.size(); ++i) {
    const glm::dvec3 p = positions[i] + glm::dvec3{0.0, 0.0, height};
    Renderer(camera_at(p, 0.2 * p.x, 0.1 * p.y), Imaging{}, i).render(board, 0.0, 0, images[i]);
  }
  return images;
}

/// A source that reports a number of images but has none.
class Claim : public ImageSource {
 public:
  explicit Claim(std::size_t size) : size_(size) {}
  bool next(Image&) override { return ADD_FAILURE() << "nothing is to be read", false; }
  std::size_t size() const override { return size_; }

 private:
  std::size_t size_;
};

Image grey_image(int width, int height) {
  return {width, height, 1, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height, 99)};
}

std::string error_of(ImageSource&& images) {
  return refusal_of([&] { calibrate(images, "album", kBoard, {}); });
}

}  // namespace

TEST(Calibration, FindsIntrinsicsOfTheImages) {
  std::vector<Image> images = rendered(chessboard(), 0.6);
  images.push_back(grey_image(640, 480));  // without a board
  images.emplace_back();                   // an unreadable file
  std::vector<std::size_t> progress;
  ImagesInMemory album(images);
  const Calibration c = calibrate(album, "album", kBoard, [&](std::size_t done) { progress.push_back(done); });
  EXPECT_LT(c.residual, 0.1);
  EXPECT_GT(c.residual, 0.001);
  ASSERT_EQ(c.residuals.size(), 8u);
  EXPECT_TRUE(c.residuals[0]);
  EXPECT_FALSE(c.residuals[6]);
  EXPECT_FALSE(c.residuals[7]);
  EXPECT_EQ(progress, (std::vector<std::size_t>{1, 2, 3, 4, 5, 6, 7, 8}));
  const Intrinsics truth = camera_at({0.0, 0.0, 1.0}, 0.0, 0.0).intrinsics;
  EXPECT_EQ(c.intrinsics.width, 640);
  EXPECT_EQ(c.intrinsics.height, 480);
  EXPECT_NEAR(c.intrinsics.focal.x, truth.focal.x, 2.0);
  EXPECT_NEAR(c.intrinsics.focal.y, truth.focal.y, 2.0);
  EXPECT_NEAR(c.intrinsics.center.x, truth.center.x, 2.0);
  EXPECT_NEAR(c.intrinsics.center.y, truth.center.y, 2.0);
  EXPECT_NEAR(c.intrinsics.distortion[0], truth.distortion[0], 0.02);
}

TEST(Calibration, FindsIntrinsicsFromPartsOfABoardWithTags) {
  std::vector<Image> images = rendered(board_with_tags(), 0.45);
  images.push_back(grey_image(640, 480));  // without a board
  const auto seen = opencv().find_board(images[0], kBoardWithTags);
  EXPECT_GT(seen.size(), 6u);
  EXPECT_LT(seen.size(), 49u) << "the board is larger than the picture";
  ImagesInMemory album(images);
  const Calibration c = calibrate(album, "album", kBoardWithTags, {});
  EXPECT_LT(c.residual, 0.15);
  EXPECT_GT(c.residual, 0.001);
  ASSERT_EQ(c.residuals.size(), 7u);
  EXPECT_FALSE(c.residuals[6]);
  const Intrinsics truth = camera_at({0.0, 0.0, 1.0}, 0.0, 0.0).intrinsics;
  EXPECT_NEAR(c.intrinsics.focal.x, truth.focal.x, 3.0);
  EXPECT_NEAR(c.intrinsics.focal.y, truth.focal.y, 3.0);
  EXPECT_NEAR(c.intrinsics.center.x, truth.center.x, 3.0);
  EXPECT_NEAR(c.intrinsics.center.y, truth.center.y, 3.0);
  EXPECT_NEAR(c.intrinsics.distortion[0], truth.distortion[0], 0.03);
}

/// Boundary: 8 x 8 squares need 32 tags; the dictionary has 30.
TEST(Calibration, RejectsABoardWithMoreTagsThanItsDictionary) {
  Chessboard board = kBoardWithTags;
  board.dictionary = "apriltag_16h5";
  EXPECT_EQ(refusal_of([&] { opencv().find_board(grey_image(64, 48), board); }),
            "a board with 7 x 7 inner corners has 32 tags, and 'apriltag_16h5' has 30");
}

TEST(Calibration, ReportsMissingInput) {
  EXPECT_NE(error_of(ImagesInMemory(std::vector<Image>(4, grey_image(64, 48))))
                .find("found in 0 of 4 images; expected at least 3"),
            std::string::npos);
  EXPECT_NE(error_of(ImagesInMemory({})).find("found in 0 of 0 images"), std::string::npos);
  EXPECT_EQ(error_of(ImagesInMemory({grey_image(64, 48), grey_image(48, 64)})),
            "album: image 2 is 48 x 64, but the first is 64 x 48; expected images of one camera");
}

TEST(Calibration, LimitsItsWork) {
  const char* const kMany = "album: has more than 200 images; expected fewer, all different";
  EXPECT_EQ(error_of(Claim(201)), kMany);  // detected before any image is read
  EXPECT_EQ(error_of(ImagesInMemory(std::vector<Image>(201, Image{16, 16, 1, {}}))), kMany);  // as in a video
  Image large{1 << 20, 1 << 11, 1, {0}};  // 2^31 pixels, which are never read
  large.width += 1;
  EXPECT_EQ(error_of(ImagesInMemory({large})),
            "album: has images of more than 2048 Mpx in all; expected fewer or smaller ones");
}

TEST(Calibration, SearchesImagesOfTagsWithoutStalling) {
  // Squares within squares, but no chessboard: OpenCV's other search needs 20 s for such an image, this one 0.3 s.
  Testbed testbed;
  testbed.tag.height = 0.2;
  testbed.cameras.push_back({distorted_camera(), ""});
  Image image;
  Renderer(distorted_camera(), Imaging{}, 1)
      .render(RenderedFleet(testbed, {30, 0.5, 0, true, 1}).scene_at(0.0), 0.0, 0, image);
  EXPECT_TRUE(opencv().find_board(image, {9, 6, 0.025}).empty());
}

TEST(Calibration, FailsWithoutPixels) { EXPECT_THROW(opencv().find_board(Image{}, kBoard), base::InputError); }

}  // namespace sf::vision
