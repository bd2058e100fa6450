// A camera's pose by OpenCV's calib3d: SQPnP (G. Terzakis, M. Lourakis, 2020), then Levenberg-Marquardt.

#include "vision/opencv/placement.h"

#include <opencv2/calib3d.hpp>

#include "vision/opencv/images.h"

namespace sf::vision {

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
