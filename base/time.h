#pragma once
// Simulated time: a count of nanoseconds.

#include <cmath>
#include <cstdint>

namespace sf::base {

inline constexpr std::int64_t kSecond = 1'000'000'000;  ///< [ns]

/// Returns the nearest whole number of nanoseconds. @param seconds magnitude below 9.2e9
inline std::int64_t nanoseconds(double seconds) { return std::llround(1e9 * seconds); }

}  // namespace sf::base
