#pragma once
// Overwrites the farm's results between ticks, to detect results that are not written.

#include <cstdint>
#include <span>

#include "base/reading.h"

namespace sf::bench {

/// Overwrites the results of the last tick in place: the spans refer to the tables that the next tick writes.
void poison(std::span<const base::ReadingBlock> readings);

/// Returns the number of values that are still overwritten.
std::size_t unwritten(std::span<const base::ReadingBlock> readings);

/// Returns the hash of all ranges, in order.
std::uint64_t hash_ranges(std::span<const base::ReadingBlock> readings);

}  // namespace sf::bench
