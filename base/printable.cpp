#include "base/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

namespace sf::base {

namespace {

/// Returns the length of the UTF-8 sequence at the start of `text` [bytes]; 0 if it is invalid.
std::size_t sequence(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::size_t size = byte(0) < 0x80   ? 1
                           : byte(0) < 0xC2 ? 0
                           : byte(0) < 0xE0 ? 2
                           : byte(0) < 0xF0 ? 3
                           : byte(0) < 0xF5 ? 4
                                            : 0;
  if (size > text.size()) return 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const bool overlong = (byte(0) == 0xE0 && byte(1) < 0xA0) || (byte(0) == 0xF0 && byte(1) < 0x90);
  const bool beyond = (byte(0) == 0xED && byte(1) > 0x9F) || (byte(0) == 0xF4 && byte(1) > 0x8F);
  return size > 2 && (overlong || beyond) ? 0 : size;
}

bool is_control(std::string_view text, std::size_t size) {
  const auto first = static_cast<std::uint8_t>(text[0]);
  if (size == 1) return (first < 0x20 && first != '\n' && first != '\t') || first == 0x7F;
  return size == 2 && first == 0xC2 && static_cast<std::uint8_t>(text[1]) < 0xA0;
}

}  // namespace

std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view rest = text.substr(at);
    const std::size_t size = sequence(rest);
    const std::size_t taken = std::max<std::size_t>(1, size);
    if (size > 0 && !is_control(rest, size))
      out += rest.substr(0, taken);
    else
      for (std::size_t i = 0; i < taken; ++i) out += fmt::format("\\x{:02x}", static_cast<std::uint8_t>(rest[i]));
    at += taken;
  }
  return out;
}

std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const bool blank = c == '\n' || c == '\r' || c == '\t';
    if (!blank)
      line += c;
    else if (!line.ends_with(' '))
      line += ' ';
  }
  return printable(line);
}

}  // namespace sf::base
