#pragma once
// A fault of sensors over an interval of time, as a scenario states it.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/fault.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::farm {

/// [byte] Largest memory of the readings that delays of a run hold back.
inline constexpr double kMostDelayed = 1e9;

struct Fault {
  base::FaultKind kind = base::FaultKind::bias;
  std::string robot;         ///< name; "*": all robots, including those that join
  std::string type;          ///< name or keyword of a sensor type
  std::uint32_t sensor = 0;  ///< number among the robot's sensors of this type
  std::string column;        ///< whose values it alters; empty: the first. Not for stuck, swap, dropout, delay
  std::optional<std::uint32_t> element;         ///< row that it alters; nullopt: all rows
  std::vector<std::string> swapped_columns;     ///< swap: two columns of equal width, or
  std::vector<std::uint32_t> swapped_elements;  ///< two rows with all their columns
  /// bias [unit of the column]; drift [unit/s]; scale [1]; spikes [unit], their height; noise: standard deviation
  /// [unit], or with `multiplies` [1] >= 1, the resulting deviation in units of the sensor's own; quantization [unit],
  /// the step; delay [s].
  double amount = 0.0;
  bool multiplies = false;
  double from = 0.0;                                       ///< [s] first time of measurement
  double until = std::numeric_limits<double>::infinity();  ///< [s] first time after it
  double probability = 1.0;                                ///< per reading; for spikes per value
  std::string file;                                        ///< for errors, like `line`
  int line = 0;
};

/// @throws base::InputError at the fault's line: for a robot or sensor that the world lacks, a column or element that
/// the sensor lacks, a multiple of noise that is not stated, values that are not numbers (maps), and delays that would
/// hold back more than kMostDelayed
void check_faults(std::span<const Fault> faults, const world::World& world, const sensors::SensorSet& sensor_set);

}  // namespace sf::farm
