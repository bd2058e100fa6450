#pragma once
// Ticks and samples of a farm as the copies of its world see them: a copy takes part in those that a farm of its world
// alone would have.

#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "raycast/episodes.h"

namespace sf::farm {

/// Not thread-safe.
class CopyCalls {
 public:
  explicit CopyCalls(const raycast::Episodes& episodes)
      : copies_(episodes.copies()), takes_part_(copies_.copies(), 1), hashes_(copies_.copies(), 0) {}

  /// Begins a call. @param all whether all copies take part; otherwise those of `add`
  void begin(bool all) { takes_part_.assign(takes_part_.size(), all ? 1 : 0); }
  void add(std::uint32_t mover) { takes_part_[copies_.copy_of(mover)] = 1; }
  bool has(std::uint32_t mover) const { return takes_part_[copies_.copy_of(mover)] != 0; }

  /// Chains the hashes of the call's readings, in order, to those of the copies that take part.
  void chain(std::span<const base::ReadingBlock> readings, std::span<const std::uint64_t> hashes);
  void restart(std::uint32_t copy) { hashes_[copy] = 0; }
  std::uint64_t hash_of(std::uint32_t copy) const { return hashes_.at(copy); }

 private:
  world::CopyIndex copies_;
  std::vector<std::uint8_t> takes_part_;  ///< per copy
  std::vector<std::uint64_t> hashes_;     ///< per copy
  std::vector<std::size_t> first_;        ///< scratch: per copy, its first entry in `sorted_`, and the end
  std::vector<std::uint64_t> sorted_;     ///< scratch: by copy
};

}  // namespace sf::farm
