#include "viz/video_file.h"

#include <utility>

#include "base/error.h"
#include "base/plugin.h"

namespace sf::viz {
namespace {

const VideoBackend& video_backend() {
  static const auto* const loaded = static_cast<const VideoBackend*>(
      base::load_plugin(kVideoBackendSymbol, "no video can be written; `view RECORDING --frames DIR` writes PNG files",
                        "FFmpeg (Debian: apt-get install ffmpeg)"));
  return *loaded;
}

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw base::InputError(path, 0, "the video cannot be written: " + why);
}

}  // namespace

VideoFile::VideoFile(const std::string& path, const VideoFormat& format) : path_(path), format_(format) {
  std::string why;
  video_ = video_backend().open(path.c_str(), format, why);
  if (video_ == nullptr) refuse(path, why);
}

VideoFile::~VideoFile() {
  std::string ignored;
  if (video_ != nullptr) video_backend().close(video_, ignored);
}

void VideoFile::add(const PixelImage& image) {
  SF_CHECK(image.width == format_.width && image.height == format_.height, "a frame of another size");
  std::string why;
  if (!video_backend().add(video_, image.rgb.data(), why)) refuse(path_, why);
}

void VideoFile::finish() {
  std::string why;
  if (!video_backend().close(std::exchange(video_, nullptr), why)) refuse(path_, why);
}

}  // namespace sf::viz
