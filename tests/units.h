#pragma once
// Units of tests' times and angles.

#include <cmath>
#include <cstdint>
#include <limits>

namespace sf {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kDegree = M_PI / 180.0;         ///< [rad]
inline constexpr std::int64_t kMs = 1'000'000;          ///< [ns]
inline constexpr std::int64_t kSecond = 1'000'000'000;  ///< [ns]
inline constexpr std::int64_t kTick = 100'000'000;      ///< [ns] of 10 Hz

}  // namespace sf
