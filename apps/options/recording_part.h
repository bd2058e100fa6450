#pragma once
// The part of a recording that a command is about: some of its robots, for some time.

#include <cstdint>
#include <vector>

#include "apps/options/options.h"
#include "record/recording.h"

namespace sf::apps {

struct RecordingPart {
  record::Recording recording;       ///< states and lights of that time; readings of that time and those movers
  std::vector<std::uint8_t> chosen;  ///< one per mover: 1 where the command is about it
  double seconds = 0.0;              ///< from the first tick to the last
};

/// Opens a recording and prints its damage.
/// @throws base::InputError when it has no such robot, or no tick in that time.
RecordingPart open_part(const std::string& directory, const PartOption& wanted);

}  // namespace sf::apps
