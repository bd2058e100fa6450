#pragma once
// Files of learnt models (TOML), as `sensorfarm identify` writes them for derived sensors of type `model`.

#include <string>
#include <string_view>
#include <vector>

#include "robots/estimation/regression.h"
#include "sensorfarm/controller.h"

namespace sf::sensors {

struct ModelFile {
  std::vector<std::string> inputs;  ///< all numbers of all inputs, named as by `signal_names`
  std::string output;               ///< "laneedge.distance_m"
  double rate = 10.0;               ///< [Hz] > 0, of its steps
  estimation::Regression regression;
};

/// Returns the names of all numbers of a sensor's reading: "gyro.rate_rad_s", "magnetometer:1.0.field_T" of the second
/// magnetometer's first element.
std::vector<std::string> signal_names(const sensorfarm::SensorInfo& sensor);

std::string text_of(const ModelFile& model);
/// @throws base::InputError with file and line
ModelFile read_model_file(const std::string& file);
/// @param file for errors
ModelFile parse_model_file(const std::string& file, std::string_view text);

}  // namespace sf::sensors
