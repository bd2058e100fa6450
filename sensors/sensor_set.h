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

  /// The sensors of one type, at least one.
  struct Group : ParsedSensors {
    const SensorType* type = nullptr;
    std::vector<std::uint32_t> first;  ///< per mover, plus one: index of its first row
  };
  /// Returns the sensor types of this world, by id.
  std::span<const Group> groups() const { return groups_; }
  /// @return null when the world has no sensor of that type
  const Group* group(std::uint8_t type) const;

  /// Returns one mover's sensors of one type; may be empty.
  std::span<const SensorSpec> of(std::uint8_t type, std::uint32_t mover) const;
  /// Returns the further settings of all sensors of one type, or of one mover's, in the order of their specs; may be
  /// empty. @pre the type's `parse` stores a std::vector<Settings>
  template <class Settings>
  std::span<const Settings> settings_of(std::uint8_t type) const {
    const Group* found = group(type);
    return found == nullptr ? std::span<const Settings>() : std::span(found->settings_as<Settings>());
  }
  template <class Settings>
  std::span<const Settings> settings_of(std::uint8_t type, std::uint32_t mover) const {
    const auto rows = of(type, mover);
    return rows.empty() ? std::span<const Settings>()
                        : settings_of<Settings>(type).subspan(group(type)->first[mover], rows.size());
  }
  /// Returns the spec of the sensor that produced a reading.
  const SensorSpec& row(const base::ReadingBlock& reading) const;
  /// Returns the geometry of a reading that is a spatial scan (SensorType::beams).
  SpatialBeams beams(const base::ReadingBlock& reading) const;
  std::size_t count() const;                        ///< number of sensors of all types
  std::size_t count_of(std::uint32_t mover) const;  ///< number of a mover's sensors of all types

 private:
  std::vector<Group> groups_;
};

/// Returns the standard deviation of the noise of one number of an element [unit of its column], without errors that
/// last, such as a bias; infinite: not stated.
/// @param row of the group  @param offset index of the number in an element
double own_noise(const SensorSet::Group& group, const SensorSpec& row, std::uint32_t offset);

}  // namespace sf::sensors
