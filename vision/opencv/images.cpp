// Image files by OpenCV's imgcodecs, and drawing by its imgproc.

#include "vision/opencv/images.h"

#include <glm/common.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"

namespace sf::vision {

cv::Mat wrap(const Image& image) {
  return {image.height, image.width, image.channels == 1 ? CV_8UC1 : CV_8UC3,
          const_cast<std::uint8_t*>(image.pixels.data())};
}

Image read_image(const std::string& file, int channels) {
  cv::Mat read;
  try {
    read = cv::imread(file, channels == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR);
  } catch (const cv::Exception&) {
    read.release();
  }
  if (read.empty()) throw base::InputError(file, 0, "cannot be read as an image; expected PNG, JPEG, PGM, TIFF or BMP");
  Image image;
  copy(read, image);
  return image;
}

void copy(const cv::Mat& from, Image& to) {
  to.width = from.cols;
  to.height = from.rows;
  to.channels = from.channels();
  to.pixels.clear();
  for (int v = 0; v < from.rows; ++v)
    to.pixels.insert(to.pixels.end(), from.ptr(v), from.ptr(v) + static_cast<std::ptrdiff_t>(from.cols) * to.channels);
}

void draw(Image& image, const std::vector<Mark>& marks) {
  constexpr int kShift = 4;  // sub-pixel bits
  cv::Mat picture = wrap(image);
  for (const Mark& mark : marks) {
    const cv::Scalar color(mark.color[2], mark.color[1], mark.color[0]);
    std::vector<cv::Point> points;
    for (const glm::dvec2& p : mark.points) {
      const glm::dvec2 q = 16.0 * glm::clamp(p, glm::dvec2{-1e4}, glm::dvec2{1e4});
      points.emplace_back(static_cast<int>(q.x), static_cast<int>(q.y));
    }
    if (points.empty()) continue;
    if (points.size() > 1) cv::polylines(picture, points, false, color, mark.width, cv::LINE_AA, kShift);
    if (mark.text.empty()) continue;
    const cv::Point at(points.back().x / 16, points.back().y / 16);
    cv::putText(picture, mark.text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, {0, 0, 0}, 3, cv::LINE_AA);
    cv::putText(picture, mark.text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, color, 1, cv::LINE_AA);
  }
}

void write_image(const std::string& file, const Image& image) {
  bool written = false;
  try {
    written = cv::imwrite(file, wrap(image));
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) throw base::InputError(file, 0, "cannot be written; expected a path that ends in .png, .jpg or .pgm");
}

}  // namespace sf::vision
