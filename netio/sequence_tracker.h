#pragma once
// Counts loss, duplicates and reordering in a stream of numbered datagrams.

#include <cstdint>

namespace sf::netio {

/// Counts of one stream, numbered 0, 1, 2, ... by its sender.
struct SequenceTracker {
  std::uint64_t first = 0;       ///< smallest received index
  std::uint64_t next = 0;        ///< largest received index + 1
  std::uint64_t unique = 0;      ///< number of distinct indices received
  std::uint64_t duplicates = 0;  ///< received before
  std::uint64_t reordered = 0;   ///< received after a larger index
  std::uint64_t recent = 0;      ///< bit k: index next - 1 - k was received
};

/// Counts the arrival of `index`. An index 64 or more behind the largest counts as reordered, not as a duplicate.
void count_arrival(SequenceTracker& tracker, std::uint64_t index);

/// Returns the number of missing indices between the smallest and the largest. Those before are not counted, since the
/// receiver may have started after the sender; losses after the last arrival cannot be detected here.
inline std::uint64_t lost(const SequenceTracker& tracker) {
  const std::uint64_t span = tracker.next - tracker.first;
  return span > tracker.unique ? span - tracker.unique : 0;
}

}  // namespace sf::netio
