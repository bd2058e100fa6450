#pragma once
// Learns models of one sensor from others of the same robot, from recordings: for derived sensors of type `model`.

#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "record/recording.h"
#include "robots/estimation/regression_fit.h"
#include "sensors/model_file.h"

namespace sf::base {
class ThreadPool;
}

namespace sf::scenarios {

/// Bounds of one number of an input, such as a field that is strong enough.
struct InputBounds {
  std::string name;  ///< as by sensors::signal_names
  double least = -HUGE_VAL, most = HUGE_VAL;
};

struct IdentificationSignals {
  std::string robot;
  std::vector<std::string> inputs;  ///< "type" or "type:number": sensors of the robot; all their numbers count
  std::string output;               ///< the same: the first number of its readings
  double rate = 10.0;               ///< [Hz] of the model
  double least = -HUGE_VAL;         ///< outputs outside [least, most] are left out
  double most = HUGE_VAL;
  std::vector<InputBounds> where = {};  ///< steps with inputs outside are left out
};

/// Signals as derived sensors see them: at each step the newest values delivered by then.
struct IdentificationData {
  sensors::ModelFile model;  ///< names and rate, without the regression
  estimation::SampledSignals signals;
};

/// Appends the samples of a recording.
/// @throws base::InputError for an unknown robot or sensor, for sensors without recorded readings, for more than
/// kMostRegressors numbers, for unknown names in `where`, and for
/// signals that differ from those of the recordings before
void add_recording(const record::Recording& recording, const IdentificationSignals& signals, IdentificationData& data);

/// Families of models. `arx` is linear and uses past outputs, `narx` adds sigmoids, and `network` has sigmoids but no
/// past outputs.
enum class ModelKind : std::uint8_t { arx, narx, network };
inline constexpr std::string_view kModelKinds[] = {"arx", "narx", "network"};

/// Returns all structures of the kinds. @param lags, hidden each > 0 and within the limits of regression.h
std::vector<estimation::Structure> structures_of(std::span<const ModelKind> kinds, std::uint32_t inputs,
                                                 std::span<const std::uint32_t> lags,
                                                 std::span<const std::uint32_t> hidden);

/// Returns "NARX, 2 steps, 4 sigmoids".
std::string structure_name(const estimation::Structure& structure);

}  // namespace sf::scenarios
