#include "farm/copy_calls.h"

#include "base/hash.h"

namespace sf::farm {

void CopyCalls::chain(std::span<const base::ReadingBlock> readings, std::span<const std::uint64_t> hashes) {
  const auto add = [&](std::size_t copy, std::span<const std::uint64_t> own) {
    if (takes_part_[copy] != 0) hashes_[copy] = base::hash_bytes(own.data(), own.size_bytes(), hashes_[copy]);
  };
  if (hashes_.size() == 1) return add(0, hashes);
  first_.assign(hashes_.size() + 2, 0);
  for (const base::ReadingBlock& reading : readings) ++first_[copies_.copy_of(reading.mover) + 2];
  for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
  sorted_.resize(hashes.size());
  for (std::size_t i = 0; i < readings.size(); ++i)
    sorted_[first_[copies_.copy_of(readings[i].mover) + 1]++] = hashes[i];
  for (std::size_t copy = 0; copy < hashes_.size(); ++copy)
    add(copy, std::span(sorted_).subspan(first_[copy], first_[copy + 1] - first_[copy]));
}

}  // namespace sf::farm
