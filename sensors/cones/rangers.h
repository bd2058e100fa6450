#pragma once
// Sonar and infrared at work: which transducers fire, and what their echoes become.

#include <memory>
#include <span>
#include <vector>

#include "sensors/cones/cone_caster.h"

namespace sf::sensors {

/// What one kind of ranger makes of echoes.
struct RangerType {
  std::uint8_t id = 0;        ///< on the wire
  std::uint32_t columns = 1;  ///< numbers of one transducer
  ConeKernel kernel;
  /// Writes a transducer's columns. @param range [m] of the nearest echo; range_max when `met` is false. @param deviate
  /// standard normal; 0 when there is no noise.
  void (*write_reading)(const ConeArray& array, double range, bool met, double deviate, std::span<double> out);
};

/// Rows as the farm knows them.
std::vector<SensorSpec> ranger_specs(const std::vector<ConeArray>& arrays);

/// A reading renews the transducers whose turn has come since its sensor's last one, all of them when that was a round
/// ago or there was none; the others stand.
std::unique_ptr<SensorBackend> make_ranger_backend(const SensorContext& context, std::vector<ConeArray> arrays,
                                                   const RangerType& kind);

/// Whether transducer `number` fires in reading `sequence` when the last one that was taken is `last`; both count all
/// readings, taken or not. @param turns readings of a round.
bool has_fired(std::uint32_t number, std::uint32_t turns, std::uint64_t sequence, std::uint64_t last);

}  // namespace sf::sensors
