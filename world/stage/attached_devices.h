#pragma once
// Devices attached to models: sensors, with their settings as written, and magnets.

#include <string>
#include <string_view>

#include "world/stage/build_state.h"

namespace sf::world {

/// Unit of moments in world files. With this unit, the moments in the thesis agree with its readings.
inline constexpr double kMomentUnit = 1e-4;  ///< [A m^2]
inline constexpr double kMaxMoment = 1e16;   ///< as written; corresponds to 1e12 A m^2

/// Returns the keyword of the sensor type with the word `type`, or null. Valid for the lifetime of the options' list.
const SensorKeyword* find_sensor_keyword(const BuildState& b, std::string_view type);
/// Returns the type of a `derived( type "name" )`; null if no derived types are known. @throws base::InputError for an
/// unknown name
const SensorKeyword* derived_keyword(const BuildState& b, const Entity& entity);

/// Adds a sensor with the settings of `entity` to the mover of `model`. For types with `sensor( )` blocks, adds a
/// sensor per block, with the settings of the block and the common sensor settings of `entity`. Warns if no mover
/// carries the model.
/// @param X_MB the model's body frame (including its origin) in the mover's frame
/// @param name of the model, without its mover's name
void add_sensors(BuildState& b, const Entity& entity, const Model& model, const SensorKeyword& word, const Pose& X_MB,
                 double height, const std::string& name);

/// Adds a magnet if `entity` has a moment: to the mover of `model`, which becomes the next row of the models, or to the
/// world.
/// @param X_B the body frame: in the mover's frame for a mover's model, else in the world
/// @throws base::InputError for a moment out of range or a model without a width
void add_magnet(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B);

}  // namespace sf::world
