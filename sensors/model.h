#pragma once
// Model: a quantity computed from other sensors' readings by a model that was learnt from recordings, as a derived
// sensor (docs/derived.md).
//
// In a world file, inside a robot:
//   derived( type "model"  file "edge.toml"  inputs ["magnetometer"]  rate 20 )
// `file`: written by `sensorfarm identify`, relative to the world file. `inputs`: those of the model, in its order;
// and, for a model with earlier values of the output, optionally the sensor that measures it, as "measured=laneedge".
// Without it the model uses its own values. `rate` is that of the model.
//
// A reading is one row: the value in the unit of the model's output, whether it is valid, and its variance, which is
// the mean squared error in cross-validation. Not valid: before all inputs have arrived as often as the model needs,
// and where they lie outside the range of the training data, for which no error is known.

#include "sensors/sensor_type.h"

namespace sf::sensors {

inline constexpr std::uint8_t kModel = 34;  ///< wire id

/// Rows of the ports of a model.
inline constexpr std::uint32_t kModelInput = 0, kModelMeasured = 1;

extern const SensorType model_type;

}  // namespace sf::sensors
