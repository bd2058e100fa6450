#pragma once
// A copy of a reading that outlives its tick.

#include <cstdint>
#include <vector>

#include "base/reading.h"

namespace sf::farm {

/// Owns the data behind a block's spans. Storing another reading reuses the memory.
class StoredReading {
 public:
  StoredReading() = default;
  StoredReading(StoredReading&&) noexcept = default;
  StoredReading& operator=(StoredReading&&) noexcept = default;

  void take(const base::ReadingBlock& block) {
    block_ = block;
    values_.assign(block.values.begin(), block.values.end());
    hits_.assign(block.hits.begin(), block.hits.end());
    quality_.assign(block.quality.begin(), block.quality.end());
    block_.values = values_;
    block_.hits = hits_;
    block_.quality = quality_;
  }
  /// Its spans are valid until the next `take`.
  const base::ReadingBlock& block() const { return block_; }

 private:
  base::ReadingBlock block_;
  std::vector<double> values_;
  std::vector<std::uint32_t> hits_;
  std::vector<base::QualityFlag> quality_;
};

}  // namespace sf::farm
