// Video files by OpenCV's videoio: Motion JPEG in AVI, which needs no codec of the machine.

#include "vision/opencv/video.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/error.h"
#include "vision/opencv/images.h"

namespace sf::vision {

namespace {

class AviFile : public VideoFile {
 public:
  AviFile(const std::string& file, int width, int height, double rate) : file_(file) {
    attempt("writing of " + file, [&] {
      writer_.open(file, cv::CAP_OPENCV_MJPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), rate, {width, height});
    });
    if (!writer_.isOpened()) throw base::InputError(file, 0, "cannot be written as a video");
  }
  void write(const Image& image) override {
    attempt("writing of " + file_, [&] {
      cv::cvtColor(wrap(image), frame_, cv::COLOR_RGB2BGR);
      writer_.write(frame_);
    });
  }

 private:
  std::string file_;
  cv::VideoWriter writer_;
  cv::Mat frame_;
};

}  // namespace

std::unique_ptr<VideoFile> open_video(const std::string& file, int width, int height, double rate) {
  return std::make_unique<AviFile>(file, width, height, rate);
}

}  // namespace sf::vision
