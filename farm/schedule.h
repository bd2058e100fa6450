#pragma once
// Due times of sensors.

#include <cstdint>
#include <limits>

namespace sf::farm {

/// Returns the number of readings that a sensor with `rate` [Hz] and `phase` [s] has started by `now` [ns], with due
/// times phase + k / rate; 0 before the first. Exact to 1 ns for any duration.
std::uint64_t readings_started(std::int64_t now, double rate, double phase);

/// Returns the due time [ns] of reading `k`: phase + k / rate, to the nearest nanosecond; kNever beyond the range of
/// the type. Never before the time at which readings_started counts it.
std::int64_t due_time(std::uint64_t k, double rate, double phase);

inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

}  // namespace sf::farm
