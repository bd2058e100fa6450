#pragma once
// A recording in another accuracy mode: what the mode's errors would have been at the recorded poses. Each reading is
// computed twice, in that mode and in `exact`, by two farms without noise: with noise of the same seed in both, angular
// noise would turn the beams of both, and what remains is the same error.

#include <cstdint>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "record/recording.h"
#include "scenarios/error_distribution.h"
#include "scenarios/verification.h"

namespace sf::scenarios {

/// Errors of the first column of one sensor type.
struct ModeErrors {
  std::string sensor;  ///< sensor type
  std::string mode;
  std::string unit;    ///< m or T
  bool noisy = false;  ///< a recorded sensor of this type has noise; the errors are without it
  ErrorDistribution errors;
};

struct RecordedAccuracy {
  std::string words;              ///< the mode, as asked for
  std::uint64_t ticks = 0;        ///< that were recomputed
  std::vector<ModeErrors> types;  ///< of the world's sensor types that have modes
  std::vector<std::string> notes;
  bool interrupted = false;  ///< not all ticks were recomputed
  bool within_bounds() const;
};

/// Sensors are due as in a run, also where a service was recorded. @param words as for `--accuracy`
/// @throws base::InputError for a word that no sensor type, or none of the recorded world, has
RecordedAccuracy recorded_accuracy(const record::Recording& recording, gpu::Device& device, const std::string& words,
                                   const VerifyOptions& options);

}  // namespace sf::scenarios
