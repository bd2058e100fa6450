#pragma once
// Copies of a world: many worlds with the same walls, simulated as one.
//
//   world::copy_movers(world, 1000);
//   const world::CopyIndex copies(world);
//   copies.copy_of(row), copies.row_of(row);  // e.g. 7 and 0 for the first mover of copy 7
//
// Each copy has its own movers, in consecutive rows. Their names, ids and models are those of copy 0. Movers of
// different copies neither see nor touch each other.

#include <cstdint>
#include <utility>

#include "world/world.h"

namespace sf::world {

/// Maps the rows of movers to their copies, and to the rows of a world alone. Valid until movers are added.
class CopyIndex {
 public:
  CopyIndex() = default;
  explicit CopyIndex(const World& world)
      : movers_(world.copies > 1 ? static_cast<std::uint32_t>(world.movers.size()) / world.copies : 0),
        copies_(world.copies) {}

  std::uint32_t copies() const { return copies_; }
  std::uint32_t copy_of(std::uint32_t mover) const { return movers_ == 0 ? 0 : mover / movers_; }
  /// Returns the row of `mover` in its world alone.
  std::uint32_t row_of(std::uint32_t mover) const { return movers_ == 0 ? mover : mover % movers_; }
  /// Returns the row of the mover in the copy of `like` that corresponds to row `row` of a world alone.
  std::uint32_t in_copy_of(std::uint32_t like, std::uint32_t row) const { return copy_of(like) * movers_ + row; }
  /// Returns the rows of the copy of `mover`, of `movers` in all: the first, and the end.
  std::pair<std::uint32_t, std::uint32_t> rows_with(std::uint32_t mover, std::uint32_t movers) const {
    if (movers_ == 0) return {0, movers};
    const std::uint32_t first = mover - mover % movers_;
    return {first, first + movers_};
  }
  bool meet(std::uint32_t one, std::uint32_t other) const { return copy_of(one) == copy_of(other); }

 private:
  std::uint32_t movers_ = 0;  ///< per copy; 0: there is one
  std::uint32_t copies_ = 1;
};

inline constexpr std::uint32_t kMostCopies = 100'000;
inline constexpr std::size_t kMostCopiedMovers = 1'000'000;

/// Appends copies of all movers, so that there are `count` worlds. A world without movers stays as it is.
/// @throws base::InputError for 0 and for more than kMostCopies worlds or kMostCopiedMovers in all, and if a mover of
/// several worlds carries magnets
void copy_movers(World& world, std::uint32_t count);

}  // namespace sf::world
