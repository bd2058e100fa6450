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

/// Corners to about 0.05 px; empty where the board is not found.
std::vector<cv::Point2f> find_board(const cv::Mat& image, cv::Size board) {
  std::vector<cv::Point2f> corners;
  // The fast check spares the search, which takes seconds in large images without a board.
  constexpr int kFlags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
  if (!cv::findChessboardCorners(image, board, corners, kFlags)) return {};
  const cv::TermCriteria enough(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 50, 1e-3);
  cv::cornerSubPix(image, corners, {5, 5}, {-1, -1}, enough);
  return corners;
}

std::vector<cv::Point3f> corners_of(cv::Size board, double square) {
  std::vector<cv::Point3f> corners;
  for (int j = 0; j < board.height; ++j)
    for (int i = 0; i < board.width; ++i)
      corners.emplace_back(static_cast<float>(i * square), static_cast<float>(j * square), 0.0f);
  return corners;
}

}  // namespace

Calibration calibrate(const std::vector<Image>& images, int columns, int rows, double square) {
  const cv::Size board(columns, rows);
  Calibration result;
  result.residuals.resize(images.size());
  std::vector<std::vector<cv::Point2f>> found;
  std::vector<std::size_t> of;
  for (std::size_t i = 0; i < images.size(); ++i)
    if (images[i].width != images[0].width || images[i].height != images[0].height)
      throw base::InputError(fmt::format("image {} is {} x {}, and the first is {} x {}; expected images of one camera",
                                         i + 1, images[i].width, images[i].height, images[0].width, images[0].height));
  for (std::size_t i = 0; i < images.size(); ++i) {
    auto corners = find_board(wrap(images[i]), board);
    if (corners.empty()) continue;
    found.push_back(std::move(corners));
    of.push_back(i);
  }
  if (found.size() < kFewest)
    throw base::InputError(
        fmt::format("a chessboard with {} x {} inner corners was found in {} of {} images; expected at "
                    "least {}, with the board tilted in different directions",
                    columns, rows, found.size(), images.size(), kFewest));
  const std::vector<std::vector<cv::Point3f>> boards(found.size(), corners_of(board, square));
  cv::Mat matrix, distortion, errors;
  std::vector<cv::Mat> rotations, translations;
  try {
    result.residual = cv::calibrateCamera(boards, found, {images[0].width, images[0].height}, matrix, distortion,
                                          rotations, translations, cv::noArray(), cv::noArray(), errors);
  } catch (const cv::Exception& error) {
    throw base::InputError("the calibration failed: " + error.err);
  }
  for (std::size_t k = 0; k < of.size(); ++k) result.residuals[of[k]] = errors.at<double>(static_cast<int>(k));
  result.intrinsics = {images[0].width,
                       images[0].height,
                       {matrix.at<double>(0, 0), matrix.at<double>(1, 1)},
                       {matrix.at<double>(0, 2), matrix.at<double>(1, 2)},
                       {}};
  for (int k = 0; k < 5; ++k) result.intrinsics.distortion[static_cast<std::size_t>(k)] = distortion.at<double>(k);
  return result;
}

}  // namespace sf::vision
