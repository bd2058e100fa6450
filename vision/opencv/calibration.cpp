// Calibration with a chessboard (Z. Zhang, "A flexible new technique for camera calibration", 2000), using OpenCV's
// calib3d and, for boards with tags, aruco.

#include "vision/opencv/plugin.h"

#include <fmt/format.h>

#include <glm/ext/vector_int2.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "vision/opencv/images.h"
#include "vision/opencv/markers.h"

namespace sf::vision {

namespace {

constexpr std::size_t kFewest = 3;  // minimum number of images that determines all intrinsics

constexpr std::size_t kFewestCorners = 6;  // minimum for a partly visible board

cv::Point3f place_of(const Chessboard& board, int corner) {
  return {static_cast<float>(corner % board.columns * board.square),
          static_cast<float>(corner / board.columns * board.square), 0.0f};
}

/// Corners of a single row, column or diagonal do not determine a pose.
bool are_spread(const std::vector<BoardCorner>& corners, const Chessboard& board) {
  if (corners.size() < kFewestCorners) return false;
  const auto cell = [&](std::size_t i) {
    return glm::ivec2{corners[i].index % board.columns, corners[i].index / board.columns};
  };
  const glm::ivec2 along = cell(1) - cell(0);
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const glm::ivec2 other = cell(i) - cell(0);
    if (along.x * other.y != along.y * other.x) return true;
  }
  return false;
}

std::vector<BoardCorner> find_plain(const cv::Mat& grey, const Chessboard& board) {
  // A. Duda, U. Frese, "Accurate detection and localization of checkerboard corners for calibration", 2018. Its time is
  // linear in the pixels; OpenCV's other search needs 20 s for an image with some tags and no board.
  std::vector<cv::Point2f> found;
  std::vector<BoardCorner> corners;
  if (!cv::findChessboardCornersSB(grey, {board.columns, board.rows}, found, cv::CALIB_CB_NORMALIZE_IMAGE))
    return corners;
  const cv::TermCriteria enough(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 1e-3);
  cv::cornerSubPix(grey, found, {5, 5}, {-1, -1}, enough);
  for (const cv::Point2f& p : found) corners.push_back({static_cast<int>(corners.size()), {p.x, p.y}});
  return corners;
}

std::vector<BoardCorner> find_with_tags(const cv::Mat& grey, const Chessboard& board) {
  const auto dictionary = dictionary_of(board.dictionary);
  const int tags = (board.columns + 1) * (board.rows + 1) / 2;
  if (tags > dictionary->bytesList.rows)
    throw base::InputError(fmt::format("a board with {} x {} inner corners has {} tags, and '{}' has {}", board.columns,
                                       board.rows, tags, board.dictionary, dictionary->bytesList.rows));
  const auto printed =
      cv::aruco::CharucoBoard::create(board.columns + 1, board.rows + 1, static_cast<float>(board.square),
                                      static_cast<float>(board.marker), dictionary);
  std::vector<std::vector<cv::Point2f>> outlines;
  std::vector<int> ids, indices;
  std::vector<cv::Point2f> found;
  cv::aruco::detectMarkers(grey, dictionary, outlines, ids);
  if (!ids.empty()) cv::aruco::interpolateCornersCharuco(outlines, ids, grey, printed, found, indices);
  std::vector<BoardCorner> corners;
  for (std::size_t i = 0; i < found.size(); ++i) corners.push_back({indices[i], {found[i].x, found[i].y}});
  if (!are_spread(corners, board)) corners.clear();
  return corners;
}

Intrinsics intrinsics_of(const cv::Mat& matrix, const cv::Mat& distortion, int width, int height) {
  Intrinsics out{width,
                 height,
                 {matrix.at<double>(0, 0), matrix.at<double>(1, 1)},
                 {matrix.at<double>(0, 2), matrix.at<double>(1, 2)},
                 {}};
  for (int k = 0; k < 5; ++k) out.distortion[static_cast<std::size_t>(k)] = distortion.at<double>(k);
  return out;
}

}  // namespace

std::vector<BoardCorner> find_board(const Image& image, const Chessboard& board) {
  std::vector<BoardCorner> corners;
  attempt("search for a chessboard", [&] {
    const cv::Mat grey = wrap(image);
    corners = board.dictionary.empty() ? find_plain(grey, board) : find_with_tags(grey, board);
  });
  return corners;
}

Calibration calibrate(const std::vector<std::vector<BoardCorner>>& corners, const Chessboard& board, int width,
                      int height) {
  std::vector<std::vector<cv::Point2f>> found;
  std::vector<std::vector<cv::Point3f>> boards;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i].empty()) continue;
    of.push_back(i);
    auto& points = found.emplace_back();
    auto& places = boards.emplace_back();
    for (const BoardCorner& corner : corners[i]) {
      points.emplace_back(static_cast<float>(corner.pixel.x), static_cast<float>(corner.pixel.y));
      places.push_back(place_of(board, corner.index));
    }
  }
  if (found.size() < kFewest)
    throw base::InputError(
        fmt::format("a {} with {} x {} inner corners was found in {} of {} images; expected at "
                    "least {}, with the board tilted in different directions",
                    board.dictionary.empty() ? "chessboard" : "ChArUco board", board.columns, board.rows, found.size(),
                    corners.size(), kFewest));
  Calibration result;
  result.residuals.resize(corners.size());
  cv::Mat matrix, distortion, errors;
  std::vector<cv::Mat> rotations, translations;
  attempt("calibration", [&] {
    result.residual = cv::calibrateCamera(boards, found, {width, height}, matrix, distortion, rotations, translations,
                                          cv::noArray(), cv::noArray(), errors);
  });
  for (std::size_t k = 0; k < of.size(); ++k) result.residuals[of[k]] = errors.at<double>(static_cast<int>(k));
  result.intrinsics = intrinsics_of(matrix, distortion, width, height);
  return result;
}

void place(const std::vector<glm::dvec3>& places, const std::vector<glm::dvec2>& pixels, Camera& camera) {
  const Intrinsics& i = camera.intrinsics;
  const cv::Matx33d matrix(i.focal.x, 0.0, i.center.x, 0.0, i.focal.y, i.center.y, 0.0, 0.0, 1.0);
  const std::vector<double> distortion(i.distortion.begin(), i.distortion.end());
  std::vector<cv::Point3d> world;
  std::vector<cv::Point2d> image;
  for (const glm::dvec3& p : places) world.emplace_back(p.x, p.y, p.z);
  for (const glm::dvec2& p : pixels) image.emplace_back(p.x, p.y);
  cv::Mat turn, shift;
  cv::Matx33d R_CW;
  attempt("search for the camera's pose", [&] {
    cv::solvePnP(world, image, matrix, distortion, turn, shift, false, cv::SOLVEPNP_SQPNP);
    cv::solvePnPRefineLM(world, image, matrix, distortion, turn, shift);
    cv::Rodrigues(turn, R_CW);
  });
  const glm::dvec3 t{shift.at<double>(0), shift.at<double>(1), shift.at<double>(2)};
  const auto axis = [&](int row) { return glm::dvec3{R_CW(row, 0), R_CW(row, 1), R_CW(row, 2)}; };
  camera.right = axis(0);
  camera.down = axis(1);
  camera.forward = axis(2);
  camera.position = -(t.x * camera.right + t.y * camera.down + t.z * camera.forward);
}

}  // namespace sf::vision
