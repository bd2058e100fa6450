#include "maps/map_packets.h"

#include <algorithm>

#include "base/error.h"

namespace sf::maps {

namespace {

constexpr std::size_t kPartHeader = 36;  // [bytes]
constexpr std::size_t kPlainHeader = 2;

std::uint32_t word_at(std::span<const std::uint8_t> bytes, std::uint32_t i) {
  return base::ByteReader(bytes.subspan(4 * std::size_t{i})).get<std::uint32_t>();
}

bool all_sound(std::span<const std::uint8_t> bytes) {
  for (std::uint32_t i = 0; 4 * std::size_t{i} < bytes.size(); ++i)
    if (!is_valid(word_at(bytes, i))) return false;
  return true;
}

/// Checks a part against the fixed split of its map. Sums of its fields cannot overflow afterwards.
bool fits(const MapPart& part) {
  if (!is_valid(part.geometry) || part.parts != parts_of(part.geometry) || part.part >= part.parts) return false;
  return part.count == std::min(kPartWords, words(part.geometry) - part.first) && part.flags <= kTruePoses;
}

}  // namespace

std::uint32_t word_of(const MapPart& part, std::uint32_t i) {
  SF_CHECK(i < part.count, "word " + std::to_string(i) + " of " + std::to_string(part.count));
  return word_at(part.bytes, i);
}

std::uint32_t word_of(const PlainPart& part, std::uint32_t i) {
  SF_CHECK(i < part.count, "word " + std::to_string(i) + " of " + std::to_string(part.count));
  return word_at(part.bytes, i);
}

PartFault read_part(std::span<const std::uint8_t> payload, MapPart& part) {
  base::ByteReader reader(payload);
  part.geometry.left = reader.get<double>();
  part.geometry.top = reader.get<double>();
  part.geometry.cell = reader.get<double>();
  part.part = reader.get<std::uint16_t>();
  part.parts = reader.get<std::uint16_t>();
  part.geometry.word_columns = reader.get<std::uint16_t>();
  part.geometry.word_rows = reader.get<std::uint16_t>();
  part.flags = reader.get<std::uint16_t>();
  part.count = reader.get<std::uint16_t>();
  part.first = part.part * kPartWords;
  if (!reader.good() || reader.left() < 4 * std::size_t{part.count}) return PartFault::too_short;
  if (reader.left() > 4 * std::size_t{part.count}) return PartFault::too_long;
  part.bytes = payload.subspan(kPartHeader);
  return fits(part) && all_sound(part.bytes) ? PartFault::none : PartFault::out_of_range;
}

PartFault read_plain(std::span<const std::uint8_t> datagram, PlainPart& part) {
  part = {};
  if (datagram.size() < 4) return PartFault::too_short;
  part.second = datagram.size() % 4 == 0;
  part.bytes = datagram.subspan(part.second ? 0 : kPlainHeader);
  if (part.bytes.size() % 4 != 0) return PartFault::too_short;
  part.count = static_cast<std::uint32_t>(part.bytes.size() / 4);
  if (part.count > plain_half(kMaxPlainWords)) return PartFault::too_long;
  if (!part.second) {
    part.word_rows = datagram[0];
    part.word_columns = datagram[1];
    const std::uint32_t all = part.word_rows * part.word_columns;
    if (all < 1 || all > kMaxPlainWords) return PartFault::out_of_range;
    if (part.count < plain_half(all)) return PartFault::too_short;
    if (part.count > plain_half(all)) return PartFault::too_long;
  }
  return all_sound(part.bytes) ? PartFault::none : PartFault::out_of_range;
}

}  // namespace sf::maps
