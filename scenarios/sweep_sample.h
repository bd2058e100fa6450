#pragma once
// Random points of the unit cube: independent, or a Latin hypercube (McKay, Beckman and Conover, Technometrics 21,
// 1979).

#include <cstdint>
#include <vector>

namespace sf::scenarios {

enum class SampleMethod : std::uint8_t {
  latin_hypercube,  ///< each coordinate has one point in each of `points` equal intervals
  random            ///< all coordinates independent; a longer sample with the same seed begins with the shorter one
};

/// Returns the same numbers on every machine.
/// @return `points` rows of `dimensions` coordinates in [0, 1)
std::vector<std::vector<double>> sample_points(SampleMethod method, std::uint64_t points, std::size_t dimensions,
                                               std::uint64_t seed);

}  // namespace sf::scenarios
