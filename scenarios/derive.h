#pragma once
// Derived sensors that did not exist when a run was recorded, computed from its recorded readings.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/tick_record.h"
#include "record/recording.h"
#include "world/world.h"

namespace sf::scenarios {

/// A derived sensor that was added to a recorded world.
struct AddedSensor {
  std::uint32_t mover = 0;
  std::uint8_t type = 0;     ///< wire id
  std::uint32_t sensor = 0;  ///< among the mover's sensors of this type
};

/// Adds the derived sensors of a TOML file to a world: `[[derived]]` tables with `robot`, `type`, `inputs` and the
/// other properties of `derived( )` in world files, in metres and degrees.
/// @throws base::InputError with file and line
std::vector<AddedSensor> add_derived_sensors(world::World& world, const std::string& file);

/// Evaluates the added sensors on the recorded readings, tick by tick, as in a run with these sensors: the bytes are
/// the same, except that scans are recorded in 32 bits. Passes the recorded states and their readings to `sink`.
/// @param world recorded_world with the added sensors @param stop called once per tick; true ends early
/// @throws base::InputError for invalid wiring, for inputs that were not recorded, and for what sensors throw
void derive(const record::Recording& recording, const world::World& world, std::span<const AddedSensor> added,
            unsigned threads, base::Sink& sink, const std::function<bool(double part)>& stop);

}  // namespace sf::scenarios
