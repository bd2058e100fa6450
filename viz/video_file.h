#pragma once
// A video file: VP9 in WebM, encoded by the FFmpeg plug-in.

#include <cstdint>
#include <string>

#include "viz/picture_file.h"
#include "viz/video_backend.h"

namespace sf::viz {

inline constexpr const char* kVideoSuffix = ".webm";

/// Not thread-safe. Equal frames give equal bytes.
class VideoFile {
 public:
  /// @throws base::InputError if the plug-in is missing, naming its package, or the file cannot be written
  VideoFile(const std::string& path, const VideoFormat& format);
  /// Ends the file as `finish` does, but ignores errors.
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// Appends a frame. @param image of the format's size. @throws base::InputError if the file cannot be written
  void add(const PixelImage& image);
  /// Writes the remaining data and the index for seeking. @throws base::InputError as above
  void finish();

 private:
  std::string path_;
  VideoFormat format_;
  void* video_;  ///< owned by the plug-in; null: finished
};

}  // namespace sf::viz
