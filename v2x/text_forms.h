#pragma once
// How XML and JSON write the values that are no numbers.

#include <span>
#include <string>

#include "v2x/constraints.h"

namespace sf::v2x {

/// "0010": `size` bits, the most significant first.
std::string bits_text(std::uint64_t bits, unsigned size);
/// "0A1B"
std::string hex_text(std::span<const std::uint8_t> octets);
/// Octets of a text of hexadecimal digits, in any case; nothing for other texts.
std::optional<base::Bytes> read_hex(std::string_view text);
/// The name of a row; "extension-0" and so on beyond the names.
std::string row_text(std::span<const std::string_view> names, std::size_t row);
/// The reverse; nothing for an unknown name. @param extensible "extension-N" is a name
std::optional<std::uint8_t> read_row(std::span<const std::string_view> names, bool extensible, std::string_view text);

}  // namespace sf::v2x
