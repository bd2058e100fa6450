#include "base/suggest.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace sf::base {

std::string suggest(std::string_view word, std::span<const std::string_view> candidates) {
  std::uint32_t best = word.size() <= 4 ? 2 : 3;  // one more than the accepted distance
  std::string_view nearest;
  for (const std::string_view candidate : candidates) {
    const std::uint32_t distance = edit_distance(word, candidate);
    if (distance >= best) continue;
    best = distance;
    nearest = candidate;
  }
  return nearest.empty() ? std::string() : "; did you mean '" + std::string(nearest) + "'?";
}

std::string suggest(std::string_view word, std::span<const std::string_view> candidates, std::string_view text) {
  const std::string suggestion = suggest(word, candidates);
  if (suggestion.empty() || text.empty()) return fmt::format("{}{}{}", suggestion, text.empty() ? "" : "; ", text);
  const char first = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return fmt::format("{} {}{}", suggestion, first, text.substr(1));
}

std::string expected_one_of(std::string_view word, std::span<const std::string_view> candidates) {
  return suggest(word, candidates, fmt::format("expected one of: {}", fmt::join(candidates, ", ")));
}

std::uint32_t edit_distance(std::string_view a, std::string_view b) {
  constexpr std::size_t kLongest = 64;  // longer than any key, and short enough for rows on the stack
  if (a.size() > kLongest || b.size() > kLongest) return a == b ? 0 : kLongest;
  std::array<std::array<std::uint32_t, kLongest + 1>, 3> rows{};
  for (std::uint32_t j = 0; j <= b.size(); ++j) rows[0][j] = j;
  for (std::uint32_t i = 1; i <= a.size(); ++i) {
    auto& row = rows[i % 3];
    const auto& above = rows[(i - 1) % 3];
    const auto& two_above = rows[(i + 1) % 3];
    row[0] = i;
    for (std::uint32_t j = 1; j <= b.size(); ++j) {
      const std::uint32_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + change});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], two_above[j - 2] + 1);
    }
  }
  return rows[a.size() % 3][b.size()];
}

}  // namespace sf::base
