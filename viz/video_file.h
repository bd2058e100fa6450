#pragma once
// A video of pictures: VP9 in WebM, by FFmpeg, a plug-in.

#include <cstdint>
#include <string>

#include "viz/picture_file.h"
#include "viz/video_backend.h"

namespace sf::viz {

inline constexpr const char* kVideoSuffix = ".webm";

/// One thread at a time. The same frames are the same bytes.
class VideoFile {
 public:
  /// @throws base::InputError without the plug-in, naming its package, and where the file cannot be written
  VideoFile(const std::string& path, const VideoFormat& format);
  /// Ends the file as `finish` does; errors are lost.
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// The next frame. @param image of the format's size. @throws base::InputError where the file cannot be written
  void add(const PixelImage& image);
  /// Writes what is left, and the index that players seek by. @throws base::InputError as above
  void finish();

 private:
  std::string path_;
  VideoFormat format_;
  void* video_;  ///< of the plug-in; null: finished
};

}  // namespace sf::viz
