#pragma once
// All sensors of a world, grouped by type and numbered per mover.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/reading.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Immutable and thread-safe. The world need not outlive it.
class SensorSet {
 public:
  /// @throws base::InputError with file and line for a sensor with invalid settings
  explicit SensorSet(const world::World& world);

  /// All sensors of one type, by mover and in file order; at least one.
  struct Group {
    const SensorType* type = nullptr;
    std::vector<SensorSpec> rows;
    std::vector<std::uint32_t> first;  ///< per mover and one more: index of its first row
  };
  /// The sensor types of this world, by id.
  std::span<const Group> groups() const { return groups_; }
  /// @return null when the world has no sensor of that type
  const Group* group(std::uint8_t type) const;

  /// One mover's sensors of one type; may be empty.
  std::span<const SensorSpec> of(std::uint8_t type, std::uint32_t mover) const;
  /// The spec of the sensor that made a reading.
  const SensorSpec& row(const base::ReadingBlock& reading) const;
  std::size_t count() const;                        ///< of all types
  std::size_t count_of(std::uint32_t mover) const;  ///< of all types

 private:
  std::vector<Group> groups_;
};

}  // namespace sf::sensors
