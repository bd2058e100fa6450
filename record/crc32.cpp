#include "record/crc32.h"

#include <zlib.h>

namespace sf::record {

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes, std::uint32_t before) {
  // Given a null pointer, zlib answers with the start value instead of `before`.
  if (bytes.empty()) return before;
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

}  // namespace sf::record
