#pragma once
// Parts shared by SPaT and MAP (SAE J2735-2016, ISO/TS 19091). Numbers have the units of the messages, not SI: each
// comment gives the unit. Members that are not optional here are required in the messages.

#include <array>

#include "v2x/constraints.h"

namespace sf::v2x {

/// An extension of a message by a region or agency. Its octets are stored without decoding.
struct RegionalExtension {
  std::uint8_t region = 0;
  base::Bytes value;
  bool operator==(const RegionalExtension&) const = default;
};
using Regional = std::vector<RegionalExtension>;  ///< at most 4; empty: absent

struct IntersectionReference {
  std::optional<std::uint16_t> region;  ///< road regulator; 0: reserved for tests
  std::uint16_t id = 0;
  bool operator==(const IntersectionReference&) const = default;
};

inline constexpr std::int32_t kUnknownLatitude = 900'000'001;
inline constexpr std::int32_t kUnknownLongitude = 1'800'000'001;

// Constraints.
inline constexpr std::uint32_t kInvalidMinute = 527'040;
inline constexpr Whole kMinuteOfYear{0, kInvalidMinute};
inline constexpr Whole kMilliseconds{0, 65'535};  ///< in the minute; 65535: unavailable
inline constexpr Whole kRevision{0, 127};
inline constexpr Whole kByte{0, 255};
inline constexpr Whole kWord{0, 65'535};
inline constexpr Whole kLatitude{-900'000'000, kUnknownLatitude};  ///< [1e-7 degrees]
inline constexpr Whole kLongitude{-1'799'999'999, kUnknownLongitude};
inline constexpr Text kName{63};
inline constexpr ListOf<Whole> lanes(std::size_t most) { return {"LaneID", 1, most, kByte}; }
inline constexpr ListOf<> regional(std::string_view element) { return {element, 1, 4}; }

template <Is<RegionalExtension> T, class F>
void fields(T& v, F&& f) {
  f("regionId", v.region, kByte);
  f("regExtValue", v.value, Octets{});
}

template <Is<IntersectionReference> T, class F>
void fields(T& v, F&& f) {
  f.optional("region", v.region, kWord);
  f("id", v.id, kWord);
}

}  // namespace sf::v2x
