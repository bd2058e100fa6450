#pragma once
// When sensors are due.

#include <cstdint>
#include <limits>

namespace sf::farm {

/// How many readings a sensor with `rate` [Hz] and `phase` [s] should have begun by `now` [ns]: due times are
/// phase + k / rate. 0 before the first. Exact to 1 ns however long the run.
std::uint64_t readings_started(std::int64_t now, double rate, double phase);

/// When reading `k` is due [ns]: phase + k / rate, to the nearest nanosecond; kNever beyond what a time can say. Never
/// before it has begun.
std::int64_t due_time(std::uint64_t k, double rate, double phase);

inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

}  // namespace sf::farm
