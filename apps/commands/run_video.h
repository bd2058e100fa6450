#pragma once
// A run as a video or as PNG files of its frames, painted and encoded by a thread of its own while ticks are computed.

#include <cstdint>
#include <memory>
#include <string>

#include "apps/options/options.h"
#include "base/tick_record.h"
#include "record/run_info.h"
#include "world/world.h"

namespace sf::apps {

/// Rows of the movers that an option names (apps/robot_names.h). @throws base::InputError for one that the world lacks
std::vector<std::size_t> rows_of(const world::World& world, const std::vector<std::string>& texts);

struct VideoFacts {
  std::string file;  ///< or folder of the frames; empty: none
  std::uint64_t frames = 0;
  double seconds = 0.0;     ///< [s] of video
  std::uint64_t bytes = 0;  ///< of the file; 0 for frames
};

/// "250 frames, 10 s, 1.2 MB".
std::string text_of(const VideoFacts& facts);

/// Frame k of F a second shows the simulated time k / F times the speed after the first tick: poses between two ticks
/// are interpolated, readings are the newest at that time. Few frames wait for the thread, so memory is bounded; no
/// frame is left out: where encoding is slower, `write` waits.
class RunVideo {
 public:
  /// @param world copied. @param info of the same world, with all of its sensors
  /// @param hidden one per mover: 1 where it is not drawn; empty: all are drawn
  /// @throws base::InputError for robots that the world lacks, without the plug-ins, and for files that cannot be
  /// written
  RunVideo(const world::World& world, record::RunInfo info, const VideoOptions& options,
           std::vector<std::uint8_t> hidden = {});
  ~RunVideo();

  /// Ticks in order of time. @throws base::InputError where a frame could not be written
  void write(const base::TickRecord& tick);
  /// Movers joined: the last rows of `world`, which has the others in their places. Between two ticks.
  void add_movers(const world::World& world);
  /// Shows the last tick for its interval, and ends the file. @throws base::InputError as `write`
  VideoFacts finish();

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace sf::apps
