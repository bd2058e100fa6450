#include "netio/track.h"

namespace sf::netio {

namespace {

constexpr std::uint64_t kWindow = 64;

}  // namespace

void see(Track& track, std::uint64_t index) {
  if (index >= track.next) {
    const std::uint64_t ahead = index + 1 - track.next;
    track.recent = (ahead >= kWindow ? 0 : track.recent << ahead) | 1u;
    track.next = index + 1;
    ++track.unique;
    return;
  }
  const std::uint64_t behind = track.next - 1 - index;
  if (behind < kWindow) {
    const std::uint64_t bit = std::uint64_t{1} << behind;
    if ((track.recent & bit) != 0) {
      ++track.duplicates;
      return;
    }
    track.recent |= bit;
  }
  ++track.reordered;
  ++track.unique;
}

}  // namespace sf::netio
