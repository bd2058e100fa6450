#pragma once
// Driver models of an experiment.

#include <cstdint>
#include <optional>
#include <string_view>

namespace sf::scenarios {

/// Driver model between commands and wheels. See docs/experiments.md.
enum class Plant : std::uint8_t {
  ideal,  ///< commands are executed unchanged (world::DriverModel::direct)
  thesis  ///< Player's driver for the Create (world::DriverModel::player_create)
};
std::string_view name_of(Plant plant);
std::optional<Plant> plant_of(std::string_view name);

}  // namespace sf::scenarios
