#pragma once
// Wall-clock time, for messages and timing reports. Results never depend on it.

#include <chrono>

namespace sf::base {

/// [s]
inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace sf::base
