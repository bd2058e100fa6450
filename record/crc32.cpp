#include "record/crc32.h"

#include <zlib.h>

namespace sf::record {

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes, std::uint32_t before) {
  // zlib returns the initial value instead of `before` for a null pointer.
  if (bytes.empty()) return before;
  return static_cast<std::uint32_t>(crc32_z(before, bytes.data(), bytes.size()));
}

}  // namespace sf::record
