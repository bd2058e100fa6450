#pragma once
// CRC-32 as used by MCAP: the polynomial of ISO 3309 / IEEE 802.3, reflected.

#include <cstdint>
#include <span>

namespace sf::record {

/// Returns the CRC of `bytes`, continued from `before`: crc(ab) == crc(b, crc(a)). For empty input it returns `before`,
/// which is 0 by default.
std::uint32_t crc32_of(std::span<const std::uint8_t> bytes, std::uint32_t before = 0);

}  // namespace sf::record
