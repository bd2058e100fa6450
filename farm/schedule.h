#pragma once
// When sensors are due.

#include <cstdint>

namespace sf::farm {

/// How many readings a sensor with `rate` [Hz] and `phase` [s] should have begun by `now` [ns]: due times are
/// phase + k / rate. 0 before the first. Exact to 1 ns however long the run.
std::uint64_t readings_begun(std::int64_t now, double rate, double phase);

}  // namespace sf::farm
