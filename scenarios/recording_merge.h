#pragma once
// Merges the recordings of ranks that shared a fleet into one MCAP, byte-identical to that of a single process.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "record/recording.h"

namespace sf::scenarios {

/// The result of a merge.
struct MergedRecording {
  std::string file;         ///< the written file
  std::uint64_t ticks = 0;  ///< ticks that are complete in all parts
  std::uint64_t bytes = 0;
  bool truncated = false;           ///< whether a part is unfinished, because a rank was killed
  std::vector<std::string> damage;  ///< of the parts
};

/// Merges the rank-*.mcap files of one run.
/// @param places folders that contain them, or the files @param folder for the result, run.mcap @param stop polled each
/// tick; may be empty
/// @throws base::InputError if a part is missing, belongs to another run, or is not a recording; base::Interrupted,
/// without writing anything, if `stop` returns true
MergedRecording merge_recordings(std::span<const std::string> places, const std::string& folder,
                                 const std::function<bool()>& stop = {});

/// Same as record::open_recording, but reads a folder with recordings of ranks as if they were merged.
record::Recording open_run(const std::string& place);

}  // namespace sf::scenarios
