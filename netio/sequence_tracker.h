#pragma once
// What a stream of numbered datagrams says about the network: loss, duplicates, reordering.

#include <cstdint>

namespace sf::netio {

/// PacketCounts of one stream that was numbered 0, 1, 2, ... by its sender.
struct SequenceTracker {
  std::uint64_t next = 0;        ///< one more than the largest index seen
  std::uint64_t unique = 0;      ///< different indices seen
  std::uint64_t duplicates = 0;  ///< seen before
  std::uint64_t reordered = 0;   ///< came after a larger one
  std::uint64_t recent = 0;      ///< bit k: index next - 1 - k was seen
};

/// Tells the track that `index` came. One that is 64 or more behind the largest counts as reordered, not as a
/// duplicate.
void count_arrival(SequenceTracker& tracker, std::uint64_t index);

/// Indices below the largest that never came. What was lost after the last arrival, only the sender's count can tell.
inline std::uint64_t lost(const SequenceTracker& tracker) {
  return tracker.next > tracker.unique ? tracker.next - tracker.unique : 0;
}

}  // namespace sf::netio
