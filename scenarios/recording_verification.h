#pragma once
// Verification of a recording: recomputes readings from world, poses and seed. Compares this device with the recorded
// readings, and plain C++ (sensors/laser_reference.h) with the recorded scans.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "record/recording.h"

namespace sf::scenarios {

/// Readings of one sensor type, compared bit by bit. Scans of a 32-bit mode are compared with plain C++ within their
/// bound.
struct Comparison {
  std::string type;
  std::uint64_t readings = 0;
  std::uint64_t values = 0;     ///< number of compared values
  std::uint64_t different = 0;  ///< bitwise unequal or beyond the bound; any NaN equals any other
  double largest = 0.0;         ///< largest difference, in the sensor type's unit; infinite when only one side is NaN
  std::string first;            ///< location of the first difference
};

struct Verification {
  std::uint64_t ticks = 0;
  std::vector<Comparison> recomputed;  ///< by sensor type: this device against the recording
  Comparison reference;  ///< lasers: plain C++ against the recording, or against this device without recorded readings
  std::uint64_t scans = 0;           ///< total number, from which `reference` is sampled
  std::uint64_t missing = 0;         ///< recorded readings that were not due in the recomputation
  std::vector<std::string> skipped;  ///< sensor types that cannot be recomputed, with the reason
  std::vector<std::string> damage;   ///< of the recording, as reported by its reader
  bool truncated = false;            ///< the recording was not finished; all of its complete ticks were compared
  bool interrupted = false;          ///< some ticks were not compared
  std::uint64_t compared() const;  ///< total number of readings; those compared both here and in plain C++ count twice
  bool faulty() const;             ///< whether a difference, a missing reading or damage was found
  /// Returns whether nothing was faulty and something was compared. A recording without ticks is also sound, unless it
  /// was cut off, which is damage. An interrupted verification is judged as far as it went.
  bool sound() const { return !faulty() && (compared() > 0 || (ticks == 0 && !interrupted)); }
};

struct VerifyOptions {
  std::uint64_t sample = 0;  ///< scans recomputed by plain C++, spread over the run; 0: all
  unsigned threads = 0;      ///< 0: all
  /// Called with the completed fraction in [0, 1]; returns false to stop; may be empty.
  std::function<bool(double)> progress;
};

/// @throws base::InputError for a recording whose world cannot be read
Verification verify(const record::Recording& recording, gpu::Device& device, const VerifyOptions& options);

}  // namespace sf::scenarios
