#pragma once
// Text forms in XML and JSON of values that are not numbers.

#include <span>
#include <string>

#include "v2x/constraints.h"

namespace sf::v2x {

/// Returns `size` bits as "0010", most significant first.
std::string bits_text(std::uint64_t bits, unsigned size);
/// Returns octets as "0A1B".
std::string hex_text(std::span<const std::uint8_t> octets);
/// Parses hexadecimal digits in either case.
/// @return nullopt for any other text
std::optional<base::Bytes> read_hex(std::string_view text);
/// Returns the name of a row; beyond the names, "extension-0" and so on.
std::string row_text(std::span<const std::string_view> names, std::size_t row);
/// Inverts `row_text`.
/// @param extensible whether "extension-N" is a name
/// @return nullopt for an unknown name
std::optional<std::uint8_t> read_row(std::span<const std::string_view> names, bool extensible, std::string_view text);

}  // namespace sf::v2x
