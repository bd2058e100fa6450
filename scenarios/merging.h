#pragma once
// Recordings of the ranks that shared a fleet, put together: one MCAP, byte for byte the one of a single process.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "record/recording.h"

namespace sf::scenarios {

/// What was merged.
struct MergedRecording {
  std::string file;         ///< that was written
  std::uint64_t ticks = 0;  ///< as many as all parts have whole
  std::uint64_t bytes = 0;
  bool truncated = false;           ///< a part was not finished: a rank was killed
  std::vector<std::string> damage;  ///< of the parts
};

/// Merges the rank-*.mcap of one run. @param places folders that have them, or the files themselves
/// @param folder for the result, run.mcap
/// @param stop polled each tick; may be empty
/// @throws base::InputError where a part is missing, belongs to another run, or is no recording; base::Interrupted when
/// `stop` returns true: nothing is written then
MergedRecording merge_recordings(std::span<const std::string> places, const std::string& folder,
                                 const std::function<bool()>& stop = {});

/// Like record::open_recording; a folder with recordings of ranks is read as if it were merged.
record::Recording open_run(const std::string& place);

}  // namespace sf::scenarios
