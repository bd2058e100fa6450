#pragma once
// Writes a run as a video or as PNG files of its frames. A separate thread paints and encodes while ticks are computed.

#include <cstdint>
#include <memory>
#include <string>

#include "apps/commands/frame_sink.h"
#include "apps/options/options.h"
#include "base/tick_record.h"
#include "record/run_info.h"
#include "world/world.h"

namespace sf::apps {

/// Returns the rows of the movers named in an option (apps/robot_names.h). @throws base::InputError for a name that the
/// world lacks
std::vector<std::size_t> rows_of(const world::World& world, const std::vector<std::string>& texts);

/// Frame k at F frames per second shows the simulated time k / F times the speed after the first tick. Poses are
/// interpolated between ticks; readings are the newest at that time. The queue of frames is bounded and no frame is
/// dropped: `write` blocks if encoding is slower.
class RunVideo {
 public:
  /// @param world copied. @param info of the same world, with all of its sensors
  /// @param hidden one per mover: 1 if it is not drawn; empty: all are drawn
  /// @throws base::InputError for unknown robots, missing plug-ins and files that cannot be written
  RunVideo(const world::World& world, record::RunInfo info, const VideoOptions& options,
           std::vector<std::uint8_t> hidden = {});
  ~RunVideo();

  /// Adds a tick, in order of time. @throws base::InputError if a frame could not be written
  void write(const base::TickRecord& tick);
  /// Adds movers that joined in the last rows of `world`; the other rows are unchanged. Called between two ticks.
  void add_movers(const world::World& world);
  /// Shows the last tick for its interval, and closes the file. @throws base::InputError as `write`
  VideoFacts finish();

 private:
  class Work;
  std::unique_ptr<Work> work_;
};

}  // namespace sf::apps
