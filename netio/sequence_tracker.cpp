#include "netio/sequence_tracker.h"

#include <algorithm>

namespace sf::netio {

namespace {

constexpr std::uint64_t kHistory = 64;

}  // namespace

void count_arrival(SequenceTracker& tracker, std::uint64_t index) {
  tracker.first = tracker.next == 0 ? index : std::min(tracker.first, index);
  if (index >= tracker.next) {
    const std::uint64_t ahead = index + 1 - tracker.next;
    tracker.recent = (ahead >= kHistory ? 0 : tracker.recent << ahead) | 1u;
    tracker.next = index + 1;
    ++tracker.unique;
    return;
  }
  const std::uint64_t behind = tracker.next - 1 - index;
  if (behind < kHistory) {
    const std::uint64_t bit = std::uint64_t{1} << behind;
    if ((tracker.recent & bit) != 0) {
      ++tracker.duplicates;
      return;
    }
    tracker.recent |= bit;
  }
  ++tracker.reordered;
  ++tracker.unique;
}

}  // namespace sf::netio
