#pragma once
// The part of a recording that a command processes: some robots over some time.

#include <cstdint>
#include <vector>

#include "apps/options/options.h"
#include "record/recording.h"

namespace sf::apps {

struct RecordingPart {
  record::Recording recording;       ///< states and lights of the time span; readings of the chosen movers in it
  std::vector<std::uint8_t> chosen;  ///< one per mover: 1 if the mover is chosen
  double seconds = 0.0;              ///< from the first tick to the last
  /// Per mover: states before the time span, by time.
  std::vector<std::vector<record::StateSample>> before;
};

/// Opens a recording and prints its damage.
/// @throws base::InputError if it lacks a named robot or has no tick in the time span.
RecordingPart open_part(const std::string& directory, const PartOption& wanted);

}  // namespace sf::apps
