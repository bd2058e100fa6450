#pragma once
// Suggestions for misspelt words.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace sf::base {

/// Returns `; did you mean 'x'?` with the nearest candidate at an edit distance of at most 2 (at most 1 for words of up
/// to four letters), or an empty text.
std::string suggest(std::string_view word, std::span<const std::string_view> candidates);

/// Returns `; did you mean 'x'? Text` for a `text` in lower case, or `; text` without a near candidate.
std::string suggest(std::string_view word, std::span<const std::string_view> candidates, std::string_view text);

/// Returns `; did you mean 'x'? Expected one of: x, y, z`, or `; expected one of: x, y, z` without a near candidate.
std::string expected_one_of(std::string_view word, std::span<const std::string_view> candidates);

/// Returns the optimal string alignment distance: insertions, deletions, substitutions and swaps of neighbours.
std::uint32_t edit_distance(std::string_view a, std::string_view b);

}  // namespace sf::base
