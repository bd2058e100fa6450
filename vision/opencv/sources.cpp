// Devices, pipelines and videos with OpenCV's videoio, and folders of images.

#include "vision/opencv/plugin.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <opencv2/videoio/registry.hpp>
#include <optional>
#include <set>
#include <thread>

#include "base/error.h"
#include "vision/opencv/gstreamer.h"
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
  bool skip() override { return at_ < files_.size() && ++at_; }
  std::size_t size() const override { return files_.size(); }

 private:
  std::vector<std::string> files_;
  std::size_t at_ = 0;
};

class Video : public ImageSource {
 public:
  /// @param reopened opens the source again; empty: it cannot be
  Video(cv::VideoCapture capture, std::string source, bool live, std::function<cv::VideoCapture()> reopened = {})
      : capture_(std::move(capture)), source_(std::move(source)), live_(live), reopened_(std::move(reopened)) {}
  bool next(Image& out) override {
    bool more = false;
    attempt("reading of " + source_, [&] {
      more = capture_.read(frame_);
      if (more && frame_.channels() != 1) cv::cvtColor(frame_, grey_, cv::COLOR_BGR2GRAY);
    });
    if (more) copy(frame_.channels() == 1 ? frame_ : grey_, source_, out);
    return more;
  }
  bool skip() override {
    bool more = false;
    attempt("reading of " + source_, [&] { more = capture_.grab(); });
    return more;
  }
  bool can_reopen() const override { return reopened_ != nullptr; }
  bool reopen() override {
    capture_.release();
    capture_ = reopened_();
    return capture_.isOpened();
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
  std::function<cv::VideoCapture()> reopened_;
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

constexpr const char* kExpected =
    "a device such as /dev/video0, firewire:0, \"gstreamer:v4l2src device=/dev/video0\", a video, an image or a "
    "folder of images";

/// Opens a video with one of OpenCV's readers. Returns a closed one if that fails.
template <class Source>
cv::VideoCapture open_capture(const Source& source, cv::VideoCaptureAPIs reader) {
  // The error of the caller is sufficient; OpenCV would print the attempts of each of its readers.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  try {
    return cv::VideoCapture(source, reader);
  } catch (const cv::Exception&) {
    return {};
  }
}

void require_reader(const std::string& source, cv::VideoCaptureAPIs reader, const char* name) {
  if (!cv::videoio_registry::hasBackend(reader))
    throw base::InputError(source, 0,
                           fmt::format("needs an OpenCV with {}, which this one lacks; Debian's libopencv-videoio has "
                                       "it. Expected another source: {}",
                                       name, kExpected));
}

void request(cv::VideoCapture& capture, int width, int height, double rate) {
  capture.set(cv::CAP_PROP_FRAME_WIDTH, width);
  capture.set(cv::CAP_PROP_FRAME_HEIGHT, height);
  capture.set(cv::CAP_PROP_FPS, rate);
}

std::optional<std::string> after(const std::string& text, std::string_view prefix) {
  return text.starts_with(prefix) ? std::optional(text.substr(prefix.size())) : std::nullopt;
}

std::unique_ptr<ImageSource> open_firewire(const std::string& source, const std::string& number, int width, int height,
                                           double rate) {
  int camera = -1;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), camera);
  if (error != std::errc() || end != number.data() + number.size() || camera < 0 || camera > 62)
    throw base::InputError(source, 0,
                           "has no number of a camera; expected firewire:0 to firewire:62, as 0 for the first");
  require_reader(source, cv::CAP_FIREWIRE, "libdc1394");
  cv::VideoCapture capture = open_capture(camera, cv::CAP_FIREWIRE);
  if (!capture.isOpened())
    throw base::InputError(source, 0,
                           "cannot be opened; expected an IIDC camera (IEEE 1394) that no other program uses. Connect "
                           "it, and check that you may read and write /dev/fw*");
  request(capture, width, height, rate);
  return std::make_unique<Video>(std::move(capture), source, true);
}

/// Opens a pipeline that ends in `appsink`. @return empty, or the reason why it did not start
std::string start_pipeline(const std::string& pipeline, cv::VideoCapture& capture) {
  constexpr auto kTimeToOpen = std::chrono::seconds(10);  // for a network camera; OpenCV 4.6 would wait without limit
  if (std::string problem = pipeline_problem(pipeline); !problem.empty()) return problem;
  const auto opened = std::make_shared<std::promise<cv::VideoCapture>>();
  std::future<cv::VideoCapture> result = opened->get_future();
  // A thread inside OpenCV cannot be stopped.
  std::thread([opened, pipeline] { opened->set_value(open_capture(pipeline, cv::CAP_GSTREAMER)); }).detach();
  if (result.wait_for(kTimeToOpen) != std::future_status::ready) return "it sends no images for 10 s";
  capture = result.get();
  return capture.isOpened() ? "" : "it does not start";
}

/// A pipeline without a sink ends in one for grey or BGR images that holds only the newest.
std::unique_ptr<ImageSource> open_pipeline(const std::string& source, std::string pipeline) {
  if (pipeline.find_first_not_of(" \t") == std::string::npos)
    throw base::InputError(source, 0,
                           "names no pipeline; expected elements as for gst-launch-1.0, such as "
                           "\"gstreamer:v4l2src device=/dev/video0\"");
  require_reader(source, cv::CAP_GSTREAMER, "GStreamer");
  if (pipeline.find("appsink") == std::string::npos)
    pipeline += " ! videoconvert ! video/x-raw,format=(string){GRAY8,BGR} ! appsink max-buffers=1 drop=true";
  cv::VideoCapture capture;
  if (const std::string problem = start_pipeline(pipeline, capture); !problem.empty())
    throw base::InputError(
        source, 0,
        fmt::format("cannot be started as a GStreamer pipeline ({}); expected elements that end in raw video. Try it "
                    "with gst-launch-1.0 and \"! autovideosink\", and install the packages of its elements "
                    "(videoconvert and appsink: gstreamer1.0-plugins-base, v4l2src: gstreamer1.0-plugins-good)",
                    problem));
  return std::make_unique<Video>(std::move(capture), source, true);
}

}  // namespace

std::unique_ptr<ImageSource> open_source(const std::string& source, int width, int height, double rate) {
  if (const auto number = after(source, "firewire:")) return open_firewire(source, *number, width, height, rate);
  if (const auto pipeline = after(source, "gstreamer:")) return open_pipeline(source, *pipeline);
  std::error_code error;
  if (fs::is_directory(source, error)) return open_folder(source);
  if (!fs::exists(source, error))
    throw base::InputError(
        source, 0,
        fmt::format("does not exist; expected {}. Check its name and that the camera is connected", kExpected));
  const bool live = fs::is_character_file(source, error);
  if (!live && !fs::is_regular_file(source, error))
    throw base::InputError(source, 0, fmt::format("is a pipe, a socket or a block device; expected {}", kExpected));
  if (!live && is_image(source)) return std::make_unique<Files>(std::vector{source});
  const auto open = [=] {
    cv::VideoCapture capture = open_capture(source, live ? cv::CAP_V4L2 : cv::CAP_FFMPEG);
    if (live && capture.isOpened()) request(capture, width, height, rate);
    return capture;
  };
  cv::VideoCapture capture = open();
  if (!capture.isOpened())
    throw base::InputError(source, 0,
                           live ? "cannot be opened as a camera; expected a V4L2 device that no other program uses. "
                                  "Check that you may read "
                                  "it (group video)"
                                : fmt::format("cannot be read as a video; expected {}", kExpected));
  if (!live) return std::make_unique<Video>(std::move(capture), source, false);
  return std::make_unique<Video>(std::move(capture), source, true, open);
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
