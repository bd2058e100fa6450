#include "netio/v2x/text_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace sf::v2x {

namespace {

constexpr std::string_view kAddition = "extension-";
constexpr std::uint8_t kMaxAddition = 63;

std::optional<std::uint8_t> digit_of(char c) {
  if (c >= '0' && c <= '9') return static_cast<std::uint8_t>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<std::uint8_t>(c - 'a' + 10);
  if (c >= 'A' && c <= 'F') return static_cast<std::uint8_t>(c - 'A' + 10);
  return std::nullopt;
}

}  // namespace

std::string bits_text(std::uint64_t bits, unsigned size) {
  std::string text;
  for (unsigned i = size; i-- > 0;) text += (bits >> i & 1) != 0 ? '1' : '0';
  return text;
}

std::string hex_text(std::span<const std::uint8_t> octets) {
  std::string text;
  for (const std::uint8_t octet : octets) fmt::format_to(std::back_inserter(text), "{:02X}", octet);
  return text;
}

std::optional<base::Bytes> read_hex(std::string_view text) {
  if (text.size() % 2 != 0) return std::nullopt;
  base::Bytes octets;
  for (std::size_t i = 0; i < text.size(); i += 2) {
    const auto high = digit_of(text[i]), low = digit_of(text[i + 1]);
    if (!high || !low) return std::nullopt;
    octets.push_back(static_cast<std::uint8_t>(*high << 4 | *low));
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
