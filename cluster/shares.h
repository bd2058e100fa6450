#pragma once
// Shares of a job's work.

#include <cstdint>
#include <span>
#include <vector>

#include "cluster/ranks.h"

namespace sf::cluster {

/// Cuts a row of items into neighbouring shares of nearly equal cost: share k is [first[k], first[k + 1]), and misses
/// its due part by less than one item. @param costs one per item, not negative @param shares at least 1
/// @return shares + 1 indices, from 0 to the number of items
std::vector<std::uint32_t> equal_shares(std::span<const double> costs, unsigned shares);

/// Threads of this rank: ranks on one machine share its cores. @param wanted 0: as many as are right; else these
/// @param ranks null: a process of its own, to which 0 means all cores
unsigned threads_of(unsigned wanted, const Ranks* ranks);

}  // namespace sf::cluster
