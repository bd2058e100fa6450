#pragma once
// Biases of instruments that wander: bias instability and random walk (IEEE Std 952-1997, annex C).
//
// Bias instability B is flicker noise, of the spectral density B^2 / (2 pi f): its Allan deviation is sqrt(2 ln 2 / pi)
// B = 0.664 B for all times. Here it is the sum of kDriftTimes independent stationary Gauss-Markov processes, whose
// correlation times are powers of 4 from 1 s to 4096 s and whose variances are B^2 ln 4 / pi each. From 4 s to 1000 s
// its Allan deviation is within 8 % of 0.664 B; beyond, it falls. A random walk K changes by K sqrt(t) in a time t; its
// Allan deviation is K sqrt(t / 3).

#include <array>
#include <cstdint>

#include "base/bytes.h"
#include "base/random.h"

namespace sf::sensors {

/// In units of the instrument.
struct DriftSettings {
  double instability = 0.0;  ///< B
  double walk = 0.0;         ///< K [unit/sqrt(s)]
};

/// Returns the square of the Allan deviation of such a bias. @param time [s] > 0 of the means
double allan_variance(const DriftSettings& drift, double time);

inline constexpr std::size_t kDriftTimes = 7;

/// Bias of one axis: 0 for a random walk at reading 0.
class Drift {
 public:
  /// @param interval [s] > 0 between readings  @param draw key of its random numbers, whose `c` counts readings
  /// @param axis of its instrument
  Drift(const DriftSettings& drift, double interval, const base::RandomKey& draw, std::uint32_t axis);

  /// Goes on to a reading. From one reading to a much later one it takes one long step, of the same distribution.
  void advance(std::uint64_t reading);
  double value() const;

  void write(base::ByteWriter& out) const;
  void read(base::ByteReader& in);

 private:
  void step(std::uint64_t readings);

  DriftSettings drift_;
  double interval_;  ///< [s]
  base::RandomKey draw_;
  std::uint32_t axis_;
  std::array<double, kDriftTimes> kept_{};  ///< per process: part of the value that is left after one reading
  std::uint64_t reading_ = 0;
  std::array<double, kDriftTimes> parts_{};
  double walk_ = 0.0;
};

}  // namespace sf::sensors
