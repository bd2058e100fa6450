#include "bench/poison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hash.h"
#include "bench/caster.h"

namespace sf::bench {

void poison(std::span<const base::ReadingBlock> readings) {
  // The tables behind the spans are not const, so they may be written.
  for (const base::ReadingBlock& r : readings) {
    std::fill_n(const_cast<double*>(r.values.data()), r.values.size(), std::numeric_limits<double>::quiet_NaN());
    std::fill_n(const_cast<std::uint32_t*>(r.hits.data()), r.hits.size(), kPoisonHit);
  }
}

std::size_t unwritten(std::span<const base::ReadingBlock> readings) {
  std::ptrdiff_t count = 0;
  for (const base::ReadingBlock& r : readings) {
    count += std::count_if(r.values.begin(), r.values.end(), [](double value) { return std::isnan(value); });
    count += std::count(r.hits.begin(), r.hits.end(), kPoisonHit);
  }
  return static_cast<std::size_t>(count);
}

std::uint64_t hash_ranges(std::span<const base::ReadingBlock> readings) {
  std::uint64_t hash = 0;
  for (const base::ReadingBlock& r : readings) hash = base::hash_bytes(r.values.data(), r.values.size_bytes(), hash);
  return hash;
}

}  // namespace sf::bench
