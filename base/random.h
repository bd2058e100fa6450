#pragma once
// Counter-based random numbers: a pure function of (seed, stream, counter). Noise is therefore the same for any thread
// count, batch order or subset of robots. Philox 4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3",
// SC11).

#include <array>
#include <cstdint>

namespace sf::base {

/// Purpose of a draw. Two streams with the same key never share a number.
enum class RandomStream : std::uint32_t {
  placement = 1,
  wander = 2,
  range_noise = 3,
  angle_noise = 4,
  slip = 5,
  field_noise = 6,
  range_cone = 7,  ///< sonar and infrared rangers
  gyro = 8,
  satellites = 9,
  link = 10,         ///< delay and loss between a robot and the farm
  decision = 11,     ///< random decisions of controllers
  own_sensors = 12,  ///< users' own sensor types
  fiducials = 13,
  faults = 14,  ///< of sensors
  thermometers = 15,
  spatial_range = 16,     ///< of lidars
  spatial_second = 17,    ///< second echoes of lidars
  spatial_dropout = 18,   ///< of lidars' beams
  instrument_noise = 19,  ///< sensors::Triad: per reading and run
  instrument_drift = 20   ///< sensors::Drift
};

/// Identifies one draw by its first five fields.
struct RandomKey {
  std::uint64_t seed = 0;
  RandomStream stream = RandomStream::placement;
  std::uint32_t a = 0;  ///< e.g. robot
  std::uint32_t b = 0;  ///< e.g. sensor or attempt
  std::uint64_t c = 0;  ///< e.g. tick; the beam is passed as `index` below
  double sigma = 1.0;   ///< standard deviation of normal numbers
};

/// Returns four independent 32-bit words for draw `draw`, element `index`.
std::array<std::uint32_t, 4> random_words(const RandomKey& draw, std::uint32_t index);

/// Returns two uniform numbers in (0, 1), never 0 and never 1.
std::array<double, 2> random_uniform(const RandomKey& draw, std::uint32_t index);

/// Returns two independent normal numbers of mean 0 and standard deviation `RandomKey::sigma` (Box-Muller).
std::array<double, 2> random_normal(const RandomKey& draw, std::uint32_t index);

}  // namespace sf::base
