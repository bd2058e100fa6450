// Image files with OpenCV's imgcodecs, drawing with its imgproc.

#include "vision/opencv/images.h"

#include <fmt/format.h>

#include <glm/common.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"

namespace sf::vision {

cv::Mat wrap(const Image& image) {
  return {image.height, image.width, image.channels == 1 ? CV_8UC1 : CV_8UC3,
          const_cast<std::uint8_t*>(image.pixels.data())};
}

void attempt(const std::string& what, const std::function<void()>& work) {
  try {
    work();
  } catch (const cv::Exception& error) {
    throw base::InputError(fmt::format("the {} failed: {}", what, error.err));
  }
}

Image read_image(const std::string& file) {
  cv::Mat read;
  try {
    read = cv::imread(file, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {
    read.release();
  }
  Image image;
  copy(read, file, image);
  return image;
}

void copy(const cv::Mat& from, const std::string& source, Image& to) {
  if (std::int64_t{from.cols} * from.rows > kMaxImagePixels)
    throw base::InputError(source, 0,
                           fmt::format("has an image of {} x {} pixels; expected at most {} Mpx", from.cols, from.rows,
                                       kMaxImagePixels >> 20));
  to.width = from.cols;
  to.height = from.rows;
  to.channels = from.channels();
  to.pixels.clear();
  for (int v = 0; v < from.rows; ++v)
    to.pixels.insert(to.pixels.end(), from.ptr(v), from.ptr(v) + static_cast<std::ptrdiff_t>(from.cols) * to.channels);
}

namespace {

void draw(cv::Mat& picture, const Mark& mark) {
  constexpr int kShift = 4;  // sub-pixel bits
  const cv::Scalar color(mark.color[0], mark.color[1], mark.color[2]);
  std::vector<cv::Point> points;
  for (const glm::dvec2& p : mark.points) {
    const glm::dvec2 q = 16.0 * glm::clamp(p, glm::dvec2{-1e5}, glm::dvec2{1e5});
    points.emplace_back(static_cast<int>(q.x), static_cast<int>(q.y));
  }
  if (points.empty()) return;
  if (points.size() > 1) cv::polylines(picture, points, false, color, mark.width, cv::LINE_AA, kShift);
  if (mark.text.empty()) return;
  const cv::Point at(points.back().x / 16, points.back().y / 16);
  cv::putText(picture, mark.text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(picture, mark.text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, color, 1, cv::LINE_AA);
}

}  // namespace

void draw(Image& image, const std::vector<Mark>& marks) {
  attempt("drawing", [&] {
    cv::Mat picture = wrap(image);
    for (const Mark& mark : marks) draw(picture, mark);
  });
}

std::vector<std::uint8_t> encode_jpeg(const Image& image, int most_side) {
  std::vector<std::uint8_t> bytes;
  attempt("encoding of an image", [&] {
    cv::Mat picture = wrap(image), reduced, bgr;
    if (const double scale = static_cast<double>(most_side) / std::max(image.width, image.height); scale < 1.0) {
      // A very long image keeps at least one pixel across.
      const cv::Size size(std::max(1, static_cast<int>(scale * image.width)),
                          std::max(1, static_cast<int>(scale * image.height)));
      cv::resize(picture, reduced, size, 0.0, 0.0, cv::INTER_AREA);
      picture = reduced;
    }
    if (image.channels == 3) {
      cv::cvtColor(picture, bgr, cv::COLOR_RGB2BGR);
      picture = bgr;
    }
    cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 85});
  });
  return bytes;
}

}  // namespace sf::vision
