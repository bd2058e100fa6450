#pragma once
// Shares of a job's work.

#include <cstdint>
#include <span>
#include <vector>

namespace sf::cluster {

/// Cuts a row of items into neighbouring shares of nearly equal cost: share k is [first[k], first[k + 1]), and misses
/// its due part by less than one item. @param costs one per item, not negative @param shares at least 1
/// @return shares + 1 indices, from 0 to the number of items
std::vector<std::uint32_t> equal_shares(std::span<const double> costs, unsigned shares);

}  // namespace sf::cluster
