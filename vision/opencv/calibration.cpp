// Calibration with a chessboard (Z. Zhang, "A flexible new technique for camera calibration", 2000) by OpenCV's
// calib3d.

#include "vision/opencv/calibration.h"

#include <fmt/format.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "vision/opencv/images.h"

namespace sf::vision {

namespace {

constexpr std::size_t kFewest = 3;  // images that determine all intrinsics

std::vector<cv::Point3f> corners_of(const Chessboard& board) {
  std::vector<cv::Point3f> corners;
  for (int j = 0; j < board.rows; ++j)
    for (int i = 0; i < board.columns; ++i)
      corners.emplace_back(static_cast<float>(i * board.square), static_cast<float>(j * board.square), 0.0f);
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

std::vector<glm::dvec2> find_board(const Image& image, const Chessboard& board) {
  // A. Duda, U. Frese, "Accurate detection and localization of checkerboard corners for calibration", 2018. Its time is
  // linear in the pixels; OpenCV's other search takes 20 s of an image with some tags and no board.
  std::vector<cv::Point2f> found;
  attempt("search for a chessboard", [&] {
    const cv::Mat grey = wrap(image);
    const bool is_found =
        cv::findChessboardCornersSB(grey, {board.columns, board.rows}, found, cv::CALIB_CB_NORMALIZE_IMAGE);
    if (!is_found) return found.clear();
    const cv::TermCriteria enough(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 1e-3);
    cv::cornerSubPix(grey, found, {5, 5}, {-1, -1}, enough);
  });
  std::vector<glm::dvec2> corners;
  for (const cv::Point2f& p : found) corners.emplace_back(p.x, p.y);
  return corners;
}

Calibration calibrate(const std::vector<std::vector<glm::dvec2>>& corners, const Chessboard& board, int width,
                      int height) {
  std::vector<std::vector<cv::Point2f>> found;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i].empty()) continue;
    of.push_back(i);
    for (auto& points = found.emplace_back(); const glm::dvec2& p : corners[i])
      points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
  }
  if (found.size() < kFewest)
    throw base::InputError(
        fmt::format("a chessboard with {} x {} inner corners was found in {} of {} images; expected at "
                    "least {}, with the board tilted in different directions",
                    board.columns, board.rows, found.size(), corners.size(), kFewest));
  Calibration result;
  result.residuals.resize(corners.size());
  const std::vector<std::vector<cv::Point3f>> boards(found.size(), corners_of(board));
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

}  // namespace sf::vision
