#pragma once
// A reading that outlives the tick in which it was taken.

#include <cstdint>
#include <vector>

#include "base/reading.h"

namespace sf::farm {

/// Keeps what a block's spans point to. Taking another reuses the memory.
class StoredReading {
 public:
  StoredReading() = default;
  StoredReading(StoredReading&&) noexcept = default;
  StoredReading& operator=(StoredReading&&) noexcept = default;

  void take(const base::ReadingBlock& block) {
    block_ = block;
    values_.assign(block.values.begin(), block.values.end());
    hits_.assign(block.hits.begin(), block.hits.end());
    unsure_.assign(block.unsure.begin(), block.unsure.end());
    block_.values = values_;
    block_.hits = hits_;
    block_.unsure = unsure_;
  }
  /// Its spans live until another one is taken.
  const base::ReadingBlock& block() const { return block_; }

 private:
  base::ReadingBlock block_;
  std::vector<double> values_;
  std::vector<std::uint32_t> hits_;
  std::vector<base::Unsure> unsure_;
};

}  // namespace sf::farm
