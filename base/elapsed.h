#pragma once
// Wall-clock time, for messages and timing reports. Results never depend on it.

#include <chrono>
#include <cstdint>

namespace sf::base {

/// [s]
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// [ns] since 1970, UTC; steps where the machine's clock is set.
inline std::int64_t unix_time() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace sf::base
