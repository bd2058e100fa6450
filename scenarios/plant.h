#pragma once
// Two plants to control.

#include <cstdint>
#include <optional>
#include <string_view>

namespace sf::scenarios {

/// What stands between a command and the wheels. See docs/experiments.md.
enum class Plant : std::uint8_t {
  ideal,  ///< robots do what they are told (world::DriverModel::direct)
  thesis  ///< Player's driver for the Create stands between (world::DriverModel::player_create)
};
std::string_view name_of(Plant plant);
std::optional<Plant> plant_of(std::string_view name);

}  // namespace sf::scenarios
