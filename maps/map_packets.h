#pragma once
// Maps as little-endian payloads; docs/packets.md specifies every byte.
//
//   farm:   f64 left, top, cell; u16 part, parts, word columns, word rows, flags, count; u32 words, at most 305 per
//   part
//   thesis: two datagrams: u8 word rows, u8 word columns and the first half of the words (rounded up), then the second
//   half.
//           They can be distinguished only by their lengths.

#include <cstdint>
#include <span>

#include "base/bytes.h"
#include "maps/grid.h"

namespace sf::maps {

inline constexpr std::uint32_t kPartWords = 305;       ///< in each part except the last
inline constexpr std::uint32_t kMaxPlainWords = 1022;  ///< in a map in the thesis' form, whose datagrams stay below
                                                       ///< 2048 bytes
inline constexpr std::uint32_t kMaxPlainSide = 255;    ///< word rows and word columns of such a map
inline constexpr std::uint32_t kTruePoses = 1;         ///< flag: built from true poses, not from an estimate

inline std::uint32_t parts_of(std::uint32_t words) { return (words + kPartWords - 1) / kPartWords; }
inline std::uint32_t parts_of(const GridGeometry& geometry) { return parts_of(words(geometry)); }

/// Returns the number of words in the first datagram of the thesis' form.
inline std::uint32_t plain_half(std::uint32_t words) { return (words + 1) / 2; }

/// A receiver's view of a payload in the farm's form.
struct MapPart {
  GridGeometry geometry;
  std::uint32_t part = 0;
  std::uint32_t parts = 1;
  std::uint32_t flags = 0;
  std::uint32_t first = 0;              ///< index of its first word
  std::uint32_t count = 0;              ///< number of its words
  std::span<const std::uint8_t> bytes;  ///< 4 * count bytes; valid as long as the payload
};

/// Returns word `i` in [0, part.count).
std::uint32_t word_of(const MapPart& part, std::uint32_t i);

enum class PartFault { none, too_short, too_long, out_of_range };

/// Reads a part from arbitrary bytes. Words with the unused cell state are out of range.
PartFault read_part(std::span<const std::uint8_t> payload, MapPart& part);

/// Appends part `part` of a map. `word_at(i)` returns word i. @param flags see kTruePoses
template <class WordAt>
void put_part(const GridGeometry& geometry, std::uint32_t part, std::uint32_t flags, WordAt&& word_at,
              base::Bytes& out) {
  const std::uint32_t first = part * kPartWords;
  const std::uint32_t count = words(geometry) - first < kPartWords ? words(geometry) - first : kPartWords;
  base::ByteWriter writer(out);
  writer.put(geometry.left);
  writer.put(geometry.top);
  writer.put(geometry.cell);
  for (const std::uint32_t number : {part, parts_of(geometry), geometry.word_columns, geometry.word_rows, flags, count})
    writer.put(static_cast<std::uint16_t>(number));
  for (std::uint32_t i = 0; i < count; ++i) writer.put(std::uint32_t{word_at(first + i)});
}

/// A receiver's view of one of the thesis' two datagrams.
struct PlainPart {
  bool second = false;  ///< true: lacks rows and columns, which are in the previous datagram
  std::uint32_t word_rows = 0;
  std::uint32_t word_columns = 0;
  std::uint32_t count = 0;
  std::span<const std::uint8_t> bytes;  ///< 4 * count bytes
};

/// Reads a datagram in the thesis' form from arbitrary bytes.
PartFault read_plain(std::span<const std::uint8_t> datagram, PlainPart& part);

/// Returns word `i` in [0, part.count).
std::uint32_t word_of(const PlainPart& part, std::uint32_t i);

}  // namespace sf::maps
