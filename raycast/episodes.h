#pragma once
// The episodes of a world's copies: which random numbers their sensors draw, and when their clocks started.

#include <cstdint>
#include <memory>
#include <vector>

#include "base/random.h"
#include "world/copies.h"

namespace sf::raycast {

/// The present episode of each copy. A copy draws the numbers, and measures the times, of a world alone with its seed.
/// Objects made from one another share their episodes.
class Episodes {
 public:
  /// @param seed of a world without copies
  Episodes(std::uint64_t seed = 0) : all_(std::make_shared<std::vector<Episode>>(1, Episode{seed, 0})) {}
  /// @param world must outlive all keys' users  @param seed of copy 0; copy k has seed + k
  Episodes(const world::World& world, std::uint64_t seed) : Episodes(seed) {
    world_ = &world;
    copies_ = world::CopyIndex(world);
    while (all_->size() < copies_.copies()) all_->push_back({seed + all_->size(), 0});
  }

  const world::CopyIndex& copies() const { return copies_; }
  /// Returns the key of a random number of a mover's sensor. @param b, c as in base::RandomKey
  base::RandomKey key(base::RandomStream stream, std::uint32_t mover, std::uint32_t b, std::uint64_t c = 0) const {
    const double sigma = world_ == nullptr ? 1.0 : world_->variation_of(mover).noise;
    return {of(mover).seed, stream, copies_.row_of(mover), b, c, sigma};
  }
  /// [ns] Returns the farm's time at which the mover's clock was 0.
  std::int64_t start_of(std::uint32_t mover) const { return of(mover).start; }
  std::uint64_t seed_of(std::uint32_t mover) const { return of(mover).seed; }

  /// @param start [ns] the farm's time
  void begin(std::uint32_t copy, std::uint64_t seed, std::int64_t start) { all_->at(copy) = {seed, start}; }

 private:
  struct Episode {
    std::uint64_t seed;
    std::int64_t start;  ///< [ns]
  };
  const Episode& of(std::uint32_t mover) const { return (*all_)[copies_.copy_of(mover)]; }

  const world::World* world_ = nullptr;  ///< whose variations scale the noise; null: no variations
  world::CopyIndex copies_;
  std::shared_ptr<std::vector<Episode>> all_;
};

}  // namespace sf::raycast
