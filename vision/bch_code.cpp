#include "vision/bch_code.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace sf::vision {

namespace {

constexpr int kLength = 36, kCheck = 24;  // [bits] of a word, of its remainder
/// The product of the minimal polynomials of alpha, alpha^3, alpha^5 and alpha^7; bit i is the coefficient of x^i.
constexpr std::uint64_t kGenerator = 0x1DB2777;
constexpr BchWord kMask = 0x8F80B8750;

/// Returns the remainder of the division by the generator; 0 for a word of the code.
std::uint32_t remainder_of(BchWord word) {
  for (int i = kLength - 1; i >= kCheck; --i)
    if ((word >> i & 1) != 0) word ^= kGenerator << (i - kCheck);
  return static_cast<std::uint32_t>(word);
}

/// All patterns of at most `kBchMaxErrors` errors by their remainders, which are distinct.
using Corrections = std::vector<std::pair<std::uint32_t, BchWord>>;

void add_errors(BchWord errors, int first, int more, Corrections& into) {
  into.emplace_back(remainder_of(errors), errors);
  for (int i = first; more > 0 && i < kLength; ++i) add_errors(errors | BchWord{1} << i, i + 1, more - 1, into);
}

const Corrections& corrections() {
  static const Corrections all = [] {
    Corrections made;
    add_errors(0, 0, kBchMaxErrors, made);
    std::sort(made.begin(), made.end());
    return made;
  }();
  return all;
}

}  // namespace

BchWord encode_bch(std::uint32_t id) {
  const BchWord word = static_cast<BchWord>(id) << kCheck;
  return (word | remainder_of(word)) ^ kMask;
}

std::optional<BchMatch> decode_upright_bch(BchWord cells) {
  const BchWord word = cells ^ kMask;
  const std::uint32_t remainder = remainder_of(word);
  const auto found = std::lower_bound(corrections().begin(), corrections().end(), std::pair{remainder, BchWord{0}});
  if (found == corrections().end() || found->first != remainder) return std::nullopt;
  return BchMatch{static_cast<std::uint32_t>((word ^ found->second) >> kCheck), __builtin_popcountll(found->second), 0};
}

std::optional<BchMatch> decode_bch(BchWord cells) {
  std::optional<BchMatch> best;
  bool is_unique = false;
  for (int turned_back = 0; turned_back < 4; ++turned_back, cells = turn_bch(cells)) {
    auto match = decode_upright_bch(cells);
    if (!match || (best && match->errors > best->errors)) continue;
    is_unique = !best || match->errors < best->errors;
    match->turns = (4 - turned_back) % 4;
    best = match;
  }
  return is_unique ? best : std::nullopt;
}

BchWord turn_bch(BchWord cells) {
  BchWord turned = 0;
  for (int row = 0; row < kBchCells; ++row)
    for (int column = 0; column < kBchCells; ++column)
      turned = turned << 1 | (cells >> (kLength - 1 - (kBchCells * (kBchCells - 1 - column) + row)) & 1);
  return turned;
}

}  // namespace sf::vision
