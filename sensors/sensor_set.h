#pragma once
// Every sensor of a world, of every kind: who has which, under which number.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/reading.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Immutable. The world need not outlive it.
class SensorSet {
 public:
  /// @throws base::InputError with file and line for a sensor whose settings make no sense.
  explicit SensorSet(const world::World& world);

  /// All sensors of one kind, by mover and in file order; at least one.
  struct Group {
    const SensorType* kind = nullptr;
    std::vector<SensorSpec> rows;
    std::vector<std::uint32_t> first;  ///< per mover and one more: where its rows begin
  };
  /// The kinds this world has sensors of, by id.
  std::span<const Group> groups() const { return groups_; }
  /// @return null when the world has none of that kind.
  const Group* group(std::uint8_t kind) const;

  /// One mover's sensors of one kind; may be empty.
  std::span<const SensorSpec> of(std::uint8_t kind, std::uint32_t mover) const;
  /// The sensor that a reading came from.
  const SensorSpec& row(const base::ReadingBlock& reading) const;
  std::size_t count() const;                        ///< of all kinds
  std::size_t count_of(std::uint32_t mover) const;  ///< of all kinds

 private:
  std::vector<Group> groups_;
};

}  // namespace sf::sensors
