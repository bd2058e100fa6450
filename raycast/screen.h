#pragma once
// What is already hidden: directions around a viewpoint that something opaque covers.

#include <array>
#include <cmath>
#include <cstdint>

namespace sf::raycast {

/// A ring of narrow bins of direction, each open or covered.
class Screen {
 public:
  static constexpr int kBins = 256;

  void clear() { words_.fill(0); }

  /// Covers every bin that lies wholly within [low, high] [rad].
  void cover(double low, double high) {
    const auto first = static_cast<std::int64_t>(std::ceil(low * kBinsPerRadian));
    const auto end = static_cast<std::int64_t>(std::floor(high * kBinsPerRadian));
    for (std::int64_t bin = first; bin < end && bin < first + kBins; ++bin) word(bin) |= bit(bin);
  }

  /// True when no bin that [low, high] touches is open.
  bool covers(double low, double high) const {
    const auto first = static_cast<std::int64_t>(std::floor(low * kBinsPerRadian));
    const auto last = static_cast<std::int64_t>(std::floor(high * kBinsPerRadian));
    for (std::int64_t bin = first; bin <= last && bin < first + kBins; ++bin)
      if (!(words_[static_cast<std::size_t>(bin & (kBins - 1)) / 64] & bit(bin))) return false;
    return true;
  }

  bool covers_all() const { return (words_[0] & words_[1] & words_[2] & words_[3]) == ~std::uint64_t{0}; }

 private:
  static constexpr double kBinsPerRadian = kBins / (2.0 * M_PI);
  static std::uint64_t bit(std::int64_t bin) { return std::uint64_t{1} << (bin & 63); }
  std::uint64_t& word(std::int64_t bin) { return words_[static_cast<std::size_t>(bin & (kBins - 1)) / 64]; }

  std::array<std::uint64_t, kBins / 64> words_{};
};

}  // namespace sf::raycast
