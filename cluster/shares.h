#pragma once
// Divides a job's work into shares.

#include <cstdint>
#include <span>
#include <vector>

#include "cluster/ranks.h"

namespace sf::cluster {

/// Cuts a row of items into consecutive shares of nearly equal cost: share k is [first[k], first[k + 1]). Its cost
/// deviates from the ideal by less than one item. @param costs one per item, not negative @param shares at least 1
/// @return shares + 1 indices, from 0 to the number of items
std::vector<std::uint32_t> equal_shares(std::span<const double> costs, unsigned shares);

/// Returns the number of threads of this rank: ranks on one machine share its cores. @param wanted 0: choose a number;
/// otherwise it is returned
/// @param ranks null: a single process, for which 0 means all cores
unsigned threads_of(unsigned wanted, const Ranks* ranks);

}  // namespace sf::cluster
