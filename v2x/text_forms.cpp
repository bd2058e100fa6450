#include "v2x/text_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace sf::v2x {

namespace {

constexpr std::string_view kAddition = "extension-";
constexpr std::uint8_t kMaxAddition = 63;

}  // namespace

std::string bits_text(std::uint64_t bits, unsigned size) {
  std::string text;
  for (unsigned i = size; i-- > 0;) text += (bits >> i & 1) != 0 ? '1' : '0';
  return text;
}

std::string hex_text(std::span<const std::uint8_t> octets) { return fmt::format("{:02X}", fmt::join(octets, "")); }

std::optional<base::Bytes> read_hex(std::string_view text) {
  if (text.size() % 2 != 0) return std::nullopt;
  base::Bytes octets(text.size() / 2);
  for (std::size_t i = 0; i < octets.size(); ++i) {
    const char* const digits = text.data() + 2 * i;
    if (std::from_chars(digits, digits + 2, octets[i], 16).ptr != digits + 2) return std::nullopt;
  }
  return octets;
}

std::string row_text(std::span<const std::string_view> names, std::size_t row) {
  return row < names.size() ? std::string(names[row]) : fmt::format("{}{}", kAddition, row - names.size());
}

std::optional<std::uint8_t> read_row(std::span<const std::string_view> names, bool extensible, std::string_view text) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) return static_cast<std::uint8_t>(found - names.begin());
  if (!extensible || !text.starts_with(kAddition)) return std::nullopt;
  std::uint8_t number = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data() + kAddition.size(), end, number);
  if (read.ec != std::errc{} || read.ptr != end || number > kMaxAddition) return std::nullopt;
  return static_cast<std::uint8_t>(names.size() + number);
}

}  // namespace sf::v2x
