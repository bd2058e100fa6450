// Paint on the ground: narrow bright lines, found by a top-hat across the direction of travel. All steps are of whole
// numbers, so that results do not depend on the processor.

#include <opencv2/imgproc.hpp>

#include "vision/opencv/images.h"
#include "vision/opencv/plugin.h"

namespace sf::vision {

namespace {

constexpr double kLeastBrightness = 6.0;  // above the ground, in steps of the image: its coding in 8 bits

class TopHatPaint final : public PaintFinder {
 public:
  TopHatPaint(const GroundRaster& raster, const PaintLines& lines, const std::vector<glm::dvec2>& pixels)
      : contrast_(lines.contrast),
        across_(cv::getStructuringElement(cv::MORPH_RECT, {1 + static_cast<int>(lines.widest / raster.cell), 1})) {
    cv::Mat places(raster.rows(), raster.columns(), CV_32FC2);
    for (int row = 0; row < places.rows; ++row)
      for (int column = 0; column < places.cols; ++column) {
        const glm::dvec2 p = pixels[static_cast<std::size_t>(row) * places.cols + column];
        places.at<cv::Vec2f>(row, column) = {static_cast<float>(p.x), static_cast<float>(p.y)};
      }
    cv::convertMaps(places, cv::noArray(), whole_, part_, CV_16SC2);
    // The map's rounding to 1/32 px must not mix unseen cells with the border of the image.
    cv::extractChannel(places, unseen_, 0);
    unseen_ = unseen_ < 0.0f;
  }

  void find(const Image& image, Image& ground, Image& paint) override {
    attempt("search for paint", [&] {
      cv::remap(wrap(image), above_, whole_, part_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      above_ = cv::max(above_, 1);
      above_.setTo(0, unseen_);
      cv::GaussianBlur(above_, smooth_, {5, 5}, 0.0);
      cv::morphologyEx(smooth_, beside_, cv::MORPH_OPEN, across_);
      line_ = smooth_ - beside_;
      beside_.convertTo(least_, CV_8U, contrast_, 0.0);
      least_ = cv::max(least_, kLeastBrightness);
      line_.setTo(0, line_ < least_);
      copy(above_, "", ground), copy(line_, "", paint);
    });
  }

 private:
  double contrast_;
  cv::Mat across_, whole_, part_, unseen_;
  cv::Mat above_, smooth_, beside_, line_, least_;  // of the last image
};

}  // namespace

std::unique_ptr<PaintFinder> make_paint_finder(const GroundRaster& raster, const PaintLines& lines,
                                               const std::vector<glm::dvec2>& pixels) {
  std::unique_ptr<PaintFinder> finder;
  attempt("map of the ground", [&] { finder = std::make_unique<TopHatPaint>(raster, lines, pixels); });
  return finder;
}

}  // namespace sf::vision
