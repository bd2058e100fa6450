// Devices and videos with OpenCV's videoio, and folders of images.

#include "vision/opencv/plugin.h"

#include <algorithm>
#include <filesystem>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <set>

#include "base/error.h"
#include "vision/opencv/images.h"

namespace sf::vision {

namespace {

namespace fs = std::filesystem;

bool is_image(const fs::path& file) {
  static const std::set<std::string> kEndings{".png", ".jpg", ".jpeg", ".pgm", ".ppm", ".bmp", ".tif", ".tiff"};
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return kEndings.count(ending) > 0;
}

class Files : public ImageSource {
 public:
  explicit Files(std::vector<std::string> files) : files_(std::move(files)) {}
  bool next(Image& out) override {
    if (at_ == files_.size()) return false;
    out = read_image(files_[at_++]);
    return true;
  }
  std::size_t size() const override { return files_.size(); }

 private:
  std::vector<std::string> files_;
  std::size_t at_ = 0;
};

class Video : public ImageSource {
 public:
  Video(cv::VideoCapture capture, std::string source, bool live)
      : capture_(std::move(capture)), source_(std::move(source)), live_(live) {}
  bool next(Image& out) override {
    bool more = false;
    attempt("reading of " + source_, [&] {
      more = capture_.read(frame_);
      if (more && frame_.channels() != 1) cv::cvtColor(frame_, grey_, cv::COLOR_BGR2GRAY);
    });
    if (more) copy(frame_.channels() == 1 ? frame_ : grey_, source_, out);
    return more;
  }
  bool is_live() const override { return live_; }
  double rate() const override {
    const double rate = capture_.get(cv::CAP_PROP_FPS);
    return rate > 0.1 && rate < 1000.0 ? rate : 0.0;
  }

 private:
  cv::VideoCapture capture_;
  std::string source_;
  bool live_;
  cv::Mat frame_, grey_;
};

std::unique_ptr<ImageSource> open_folder(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  std::error_code none;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    if (is_image(at->path()) && at->is_regular_file(none)) files.push_back(at->path().string());
  if (error) throw base::InputError(folder, 0, "cannot be read: " + error.message());
  if (files.empty()) throw base::InputError(folder, 0, "has no images; expected .png, .jpg, .pgm, .tif or .bmp files");
  std::sort(files.begin(), files.end());
  return std::make_unique<Files>(std::move(files));
}

}  // namespace

std::unique_ptr<ImageSource> open_source(const std::string& source, int width, int height, double rate) {
  std::error_code error;
  if (fs::is_directory(source, error)) return open_folder(source);
  if (!fs::exists(source, error))
    throw base::InputError(source, 0,
                           "does not exist; expected a device such as /dev/video0, a video, an image or a folder");
  const bool live = fs::is_character_file(source, error);
  if (!live && !fs::is_regular_file(source, error))
    throw base::InputError(source, 0,
                           "is a pipe, a socket or a block device; expected a camera, a video, an image or a folder");
  if (!live && is_image(source)) return std::make_unique<Files>(std::vector{source});
  // The error below is sufficient; OpenCV would print the attempts of each of its readers.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  try {
    cv::VideoCapture capture(source, live ? cv::CAP_V4L2 : cv::CAP_FFMPEG);
    if (live) {
      capture.set(cv::CAP_PROP_FRAME_WIDTH, width);
      capture.set(cv::CAP_PROP_FRAME_HEIGHT, height);
      capture.set(cv::CAP_PROP_FPS, rate);
    }
    if (capture.isOpened()) return std::make_unique<Video>(std::move(capture), source, live);
  } catch (const cv::Exception&) {
  }
  throw base::InputError(source, 0,
                         live
                             ? "cannot be opened as a camera; expected a V4L2 device that no other program uses"
                             : "cannot be read as a video; expected a device, a video, an image or a folder of images");
}

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
