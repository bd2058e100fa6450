#pragma once
// Common backend of sonar and infrared: firing order, and conversion of echoes to readings. An element whose surface is
// nearer than range_min has the quality flag `too_near`.

#include <memory>
#include <span>
#include <vector>

#include "raycast/cone_caster.h"
#include "sensors/cones/cone_array.h"

namespace sf::sensors {

/// One type of ranger.
struct RangerType {
  std::uint8_t id = 0;        ///< wire id
  std::uint32_t columns = 1;  ///< numbers per transducer
  raycast::ConeKernel kernel;
  /// Writes a transducer's columns.
  /// @param range [m] of the nearest echo; range_max when `met` is false
  /// @param deviate standard normal; 0 without noise
  void (*write_reading)(const ConeArray& array, double range, bool met, double deviate, std::span<double> out);
};

/// Implements `SensorType::parse`; the further settings are ConeArrays.
ParsedSensors parse_rangers(const world::World& world, std::string_view type, ReadConeArray read);

/// Creates the backend. A reading updates the transducers that fired since its sensor's last reading: every transducer
/// after a whole cycle or for the first reading. The others keep their values.
std::unique_ptr<SensorBackend> make_ranger_backend(const SensorContext& context, const ParsedSensors& sensors,
                                                   const RangerType& type);
/// Implements `SensorType::make`.
template <const RangerType& kType>
std::unique_ptr<SensorBackend> make_ranger_backend(const SensorContext& context, const ParsedSensors& sensors) {
  return make_ranger_backend(context, sensors, kType);
}

/// Returns true when transducer `number` fires in a reading after `last`, up to and including `sequence`. Both are
/// sequence numbers, which also count skipped readings. @param turns readings per cycle
bool has_fired(std::uint32_t number, std::uint32_t turns, std::uint64_t sequence, std::uint64_t last);

}  // namespace sf::sensors
