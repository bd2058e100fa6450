#pragma once
// Three gyros or accelerometers at right angles, with the errors that data sheets state.

#include <array>
#include <cmath>
#include <glm/ext/matrix_double3x3.hpp>

#include "sensors/drift.h"

namespace sf::sensors {

/// Errors in the unit of the quantity, equal for all axes. Deviations are standard deviations of errors that are drawn
/// once for each run and axis.
struct TriadErrors {
  double noise = 0.0;         ///< [unit sqrt(s)] N: a mean over a time t has white noise of deviation N / sqrt(t)
  DriftSettings drift;        ///< wanders during a run
  double bias = 0.0;          ///< deviation
  double scale = 0.0;         ///< [-] deviation of the factor
  double misalignment = 0.0;  ///< [rad] deviation of an axis, about each of the other two
  double step = 0.0;          ///< of the output's last digit; 0: none
  double range = HUGE_VAL;    ///< > 0: the output saturates at this, either way
};

/// Returns the square of the Allan deviation, without that of rounding, for means over `time` [s] > 0.
double allan_variance(const TriadErrors& errors, double time);

/// Returns the deviation of the error of readings over `interval` [s]; infinite if part of it lasts.
double reading_deviation(const TriadErrors& errors, double interval);

/// Returns the deviation of the white noise of readings at `rate` [Hz], without errors that last.
inline double reading_noise(const TriadErrors& errors, double rate) { return errors.noise * std::sqrt(rate); }

class Triad {
 public:
  /// Numbers of a reading, and bit i where axis i saturates.
  struct Output {
    glm::dvec3 values{};
    std::uint32_t saturated = 0;
  };

  /// @param interval [s] between readings, over which each is a mean  @param cross deviation of the response to each
  /// axis of another quantity  @param noise, drift keys of its random numbers  @param number distinguishes triads of
  /// equal keys, below 8  @param noisy false: only rounding and saturation
  Triad(const TriadErrors& errors, double cross, double interval, const base::RandomKey& noise,
        const base::RandomKey& drift, std::uint32_t number, bool noisy);

  /// Returns reading number `reading`, which is not before the last one.  @param other the other quantity
  Output measure(const glm::dvec3& truth, const glm::dvec3& other, std::uint64_t reading);

  void write(base::ByteWriter& out) const {
    for (const Drift& drift : drifts_) drift.write(out);
  }
  void read(base::ByteReader& in) {
    for (Drift& drift : drifts_) drift.read(in);
  }

 private:
  TriadErrors errors_;
  base::RandomKey noise_;
  std::uint32_t number_;
  double deviation_;  ///< of the white noise of a reading
  glm::dvec3 bias_{};
  glm::dmat3 response_{1.0}, cross_{0.0};
  std::array<Drift, 3> drifts_;
};

}  // namespace sf::sensors
