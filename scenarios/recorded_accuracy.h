#pragma once
// Errors of another accuracy mode at the poses of a recording. Two farms compute each reading, one in that mode and one
// in `exact`, both without noise: angular noise would turn the beams, even if both had the same seed, and the
// difference is the error of the mode alone.

#include <cstdint>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "record/recording.h"
#include "scenarios/error_distribution.h"
#include "scenarios/recording_verification.h"

namespace sf::scenarios {

/// Errors of the first column of one sensor type.
struct ModeErrors {
  std::string sensor;  ///< sensor type
  std::string mode;
  std::string unit;    ///< m or T
  bool noisy = false;  ///< whether a recorded sensor of this type has noise; the errors exclude it
  ErrorDistribution errors;
};

struct RecordedAccuracy {
  std::string words;              ///< the mode, as requested
  std::uint64_t ticks = 0;        ///< number of recomputed ticks
  std::vector<ModeErrors> types;  ///< sensor types of the world that have modes
  std::vector<std::string> notes;
  bool interrupted = false;  ///< whether some ticks were not recomputed
  bool within_bounds() const;
};

/// Sensors are due as in a run, even if a service was recorded.
/// @param words as for `--accuracy`
/// @throws base::InputError for a word that applies to no sensor type, or to none of the recorded world
RecordedAccuracy recorded_accuracy(const record::Recording& recording, gpu::Device& device, const std::string& words,
                                   const VerifyOptions& options);

}  // namespace sf::scenarios
