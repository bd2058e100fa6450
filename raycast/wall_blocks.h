#pragma once
// Blocks of the segments that viewers in one cell may see, with their bounds.

#include <vector>

#include "raycast/candidate_walls.h"
#include "raycast/scan_tables.h"

namespace sf::raycast {

/// Appends `found`, which it sorts by rings and bearings, and the bounds of each block.
void append_blocks(std::vector<CandidateWall>& found, std::vector<SegmentBlock>& blocks,
                   std::vector<BlockBounds>& bounds);

}  // namespace sf::raycast
