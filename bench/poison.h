#pragma once
// Spoiling the farm's results between ticks.

#include <cstdint>
#include <span>

#include "base/reading.h"

namespace sf::bench {

/// Overwrites what the last tick returned, in place: its spans look into the very tables that the next tick writes.
void poison(std::span<const base::ReadingBlock> readings);

/// Values that are still spoilt.
std::size_t unwritten(std::span<const base::ReadingBlock> readings);

/// Of all ranges, in order.
std::uint64_t hash_ranges(std::span<const base::ReadingBlock> readings);

}  // namespace sf::bench
