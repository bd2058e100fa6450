#pragma once
// Frames as a video file or as PNG files in a folder.

#include <cstdint>
#include <optional>
#include <string>

#include "apps/options/options.h"
#include "viz/picture_file.h"
#include "viz/video_file.h"

namespace sf::apps {

struct VideoFacts {
  std::string file;  ///< or folder of the frames; empty: none
  std::uint64_t frames = 0;
  double seconds = 0.0;     ///< [s] of video
  std::uint64_t bytes = 0;  ///< of the file; 0 for frames
};

/// "250 frames, 10 s, 1.2 MB".
std::string video_text(const VideoFacts& facts);

class FrameSink {
 public:
  /// @param width, height [px] of all frames, even  @throws base::InputError for missing plug-ins and files that cannot
  /// be written
  FrameSink(const VideoOptions& options, int width, int height);
  /// @throws base::InputError if the frame could not be written
  void add(const viz::PixelImage& image);
  /// Closes the file. @throws base::InputError as `add`
  VideoFacts finish();

 private:
  const std::string file_;  ///< or folder
  const int frames_per_second_;
  std::uint64_t frames_ = 0;
  std::optional<viz::VideoFile> video_;  ///< nullopt: PNG files
};

}  // namespace sf::apps
