#pragma once
// Encodes videos with FFmpeg's libraries. They are in a plug-in (ffmpeg.cpp, `sensorfarm_ffmpeg.so`) that is loaded
// with the first video, and that a build or an installation may lack: Debian's FFmpeg is a GPL build (docs/figures.md).

#include <cstdint>
#include <string>

namespace sf::viz {

struct VideoFormat {
  int width = 1280, height = 720;  ///< [px] even
  int frames_per_second = 25;      ///< > 0
};

/// The functions do not throw. A video is used by one thread at a time.
struct VideoBackend {
  /// Begins a WebM file with one stream of VP9. The same frames are the same bytes.
  /// @param why out: the reason where the result is null
  void* (*open)(const char* file, const VideoFormat& format, std::string& why);
  /// Appends a frame of width * height pixels, 3 bytes each, the top row first. @return false, with the reason
  bool (*add)(void* video, const std::uint8_t* rgb, std::string& why);
  /// Writes what is left and the index, and frees the video. @return false, with the reason
  bool (*close)(void* video, std::string& why);
};

/// The name of the plug-in's only symbol: `extern "C" const VideoBackend sensorfarm_ffmpeg`.
inline constexpr const char* kVideoBackendSymbol = "sensorfarm_ffmpeg";

}  // namespace sf::viz
