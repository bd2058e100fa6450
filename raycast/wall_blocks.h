#pragma once
// Blocks of the segments that viewers in a cell may see, with their bounds.

#include <vector>

#include "raycast/candidate_walls.h"
#include "raycast/scan_tables.h"

namespace sf::raycast {

/// Sorts `found` by rings and bearings, and appends it in blocks with their bounds.
void append_blocks(std::vector<CandidateWall>& found, std::vector<SegmentBlock>& blocks,
                   std::vector<BlockBounds>& bounds);

}  // namespace sf::raycast
