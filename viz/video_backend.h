#pragma once
// Encodes videos with FFmpeg's libraries. They are in a plug-in (ffmpeg.cpp, `sensorfarm_ffmpeg.so`), loaded with the
// first video. A build or an installation may omit it, since Debian's FFmpeg is a GPL build (docs/figures.md).

#include <cstdint>
#include <string>

namespace sf::viz {

struct VideoFormat {
  int width = 1280, height = 720;  ///< The functions do not throw. A video must be used by one thread at a time.
  int frames_per_second = 25;      ///< > 0
};

/// The functions do not throw. A video is used by one thread at a time.
struct VideoBackend {
  /// Opens a WebM file with one VP9 stream. Equal frames give equal bytes.
  /// @param why out: the reason if the result is null
  void* (*open)(const char* file, const VideoFormat& format, std::string& why);
  /// Appends a frame of width * height pixels, 3 bytes each, the top row first. @return false on failure, with the
  /// reason
  bool (*add)(void* video, const std::uint8_t* rgb, std::string& why);
  /// Writes the remaining packets and the index, and frees the video. @return false on failure, with the reason
  bool (*close)(void* video, std::string& why);
};

/// The only symbol of the plug-in: `extern "C" const VideoBackend sensorfarm_ffmpeg`.
inline constexpr const char* kVideoBackendSymbol = "sensorfarm_ffmpeg";

}  // namespace sf::viz
