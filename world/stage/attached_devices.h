#pragma once
// What models do beside having a body: sensors of kinds that are not read here, and magnets.

#include <string>
#include <string_view>

#include "world/stage/build_state.h"

namespace sf::world {

/// The unit of the world file's moments: only then do the thesis' moments and its readings agree.
inline constexpr double kMomentUnit = 1e-4;  ///< [A m^2]
inline constexpr double kMaxMoment = 1e16;   ///< as written: 1e12 A m^2

/// The kind of sensor that claims `type`, or null. Lives as long as the options' list.
const SensorKeyword* find_sensor_keyword(const BuildState& b, std::string_view type);

/// Gives the mover of `model` a sensor with the settings of `entity`; warns where nobody carries it.
/// @param X_MB the model's body frame (its origin included) in the mover's frame.
/// @param name of the model without its mover's.
void add_sensor(BuildState& b, const Entity& entity, const Model& model, const SensorKeyword& word, const Pose& X_MB,
                double height, const std::string& name);

/// Adds a magnet where `entity` has a moment: to the mover of `model`, which becomes the next row of the models, or to
/// the world.
/// @param X_B the body frame, in the mover's frame for a mover's model, else in the world.
/// @throws base::InputError for a moment out of reach or a model without a width.
void add_magnet(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B);

}  // namespace sf::world
