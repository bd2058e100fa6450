#pragma once
// Wall-clock time, for messages and timing reports. Results never depend on it.

#include <chrono>
#include <cstdint>

namespace sf::base {

/// Returns the time since `start` [s].
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Returns the time since 1970, UTC [ns]. Jumps when the machine's clock is set.
inline std::int64_t unix_time() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace sf::base
