#pragma once
// Actuator models of an experiment.

#include <cstdint>
#include <optional>
#include <string_view>

namespace sf::scenarios {

/// Actuator model between commands and wheels. See docs/experiments.md.
enum class Plant : std::uint8_t {
  ideal,  ///< commands are executed unchanged (world::ActuatorModel::direct)
  thesis  ///< Player's driver for the Create (world::ActuatorModel::player_create)
};
std::string_view plant_name(Plant plant);
std::optional<Plant> plant_of(std::string_view name);

}  // namespace sf::scenarios
