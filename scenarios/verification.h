#pragma once
// A recorded run, computed again from its world, poses and seed: on this device beside what was recorded, and lasers by
// plain C++ (sensors/laser_reference.h) beside that.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "record/recording.h"

namespace sf::scenarios {

/// Readings of one kind, compared bit by bit; scans measured in 32 bits within their bound beside plain C++.
struct Comparison {
  std::string kind;
  std::uint64_t readings = 0;
  std::uint64_t values = 0;  ///< numbers in them
  std::uint64_t different =
      0;  ///< of these, not the same bits, or beyond the bound; what is not a number is the same as any other such
  double largest = 0.0;  ///< largest difference, in the kind's own unit; infinite where one side is no number
  std::string first;     ///< where the first difference is
};

struct Verification {
  std::uint64_t ticks = 0;
  std::vector<Comparison> recomputed;  ///< by kind: this device beside the recording
  Comparison reference;                ///< lasers: plain C++ beside the recording, or beside this device where no
                                       ///< readings were recorded
  std::uint64_t scans = 0;             ///< of which `reference` is a sample
  std::uint64_t missing = 0;           ///< recorded readings that this device was not due to make
  std::vector<std::string> skipped;    ///< kinds that cannot be computed again, and why
  std::vector<std::string> damage;     ///< of the recording, as its reader says
  bool interrupted = false;            ///< not all ticks were looked at
  bool sound() const;  ///< something was compared, or there are no ticks; nothing differs and nothing is damaged
};

struct VerifyOptions {
  std::uint64_t sample = 0;              ///< scans that plain C++ casts again, spread over the run; 0: all
  unsigned threads = 0;                  ///< 0: all
  std::function<bool(double)> progress;  ///< part in [0, 1]; false ends it where it is. May be empty
};

/// @throws base::InputError for a recording whose world cannot be read.
Verification verify(const record::Recording& recording, gpu::Device& device, const VerifyOptions& options);

}  // namespace sf::scenarios
