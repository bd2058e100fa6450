#ifndef MAPS_BEAM_END_H
#define MAPS_BEAM_END_H
// Where a beam ends on a map, in one word: how many columns (bits 0 to 14) and rows (15 to 29) from the sensor's cell,
// both signed, and whether it met something there (bit 30). Read by both compilers.

#define SF_END_BITS 15
#define SF_END_HIT 30

#ifdef __cplusplus

#include <cstdint>

namespace sf::maps {

inline constexpr std::int64_t kFarthestEnd = (1 << (SF_END_BITS - 1)) - 1;  ///< [cells] along columns or rows: 16 383

inline std::uint32_t pack_end(std::int64_t columns, std::int64_t rows, bool hit) {
  constexpr std::uint32_t kMask = (1u << SF_END_BITS) - 1;
  return (static_cast<std::uint32_t>(columns) & kMask) | (static_cast<std::uint32_t>(rows) & kMask) << SF_END_BITS |
         (hit ? 1u << SF_END_HIT : 0u);
}

inline std::int32_t columns_of(std::uint32_t end) {
  return static_cast<std::int32_t>(end << (32 - SF_END_BITS)) >> (32 - SF_END_BITS);
}
inline std::int32_t rows_of(std::uint32_t end) { return columns_of(end >> SF_END_BITS); }
inline bool hit_of(std::uint32_t end) { return (end >> SF_END_HIT & 1u) != 0; }

}  // namespace sf::maps

#endif
#endif
