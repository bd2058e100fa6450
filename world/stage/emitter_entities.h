#pragma once
// Model properties of infrared emitters for robots' infrared receivers (`ir_emitter` and its settings) and of lamps for
// their light sensors (`lamp_intensity`, `lamp_fov`), of heat sources for their thermometers (`heat`, `heat_radius`),
// and of fiducials for fiducial finders (`fiducial_return`,
// `fiducial_key`, `fiducial_type`).

#include "world/stage/build_state.h"

namespace sf::world {

/// Adds an emitter if `entity` has one. `model` becomes the next row of the models.
/// @throws base::InputError for an unknown kind, lengths or angles out of range, or an emitter on a mover
void add_emitter(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B);

/// Adds a lamp in the middle of the model's box if `entity` has a `lamp_intensity`. `model` becomes the next row of the
/// models. @throws base::InputError for numbers out of range, more than 1000 lamps, or a lamp on a mover
void add_lamp(BuildState& b, const Entity& entity, const Model& model, const Size& size, const Pose& X_B);

/// Adds a heat source if `entity` has a `heat`. `model` becomes the next row of the models.
/// @throws base::InputError for numbers out of range, more than 1000 sources, or a source on a mover
void add_heat_source(BuildState& b, const Entity& entity, const Model& model, const Pose& X_B);

/// Adds a fiducial in the middle of the model's box if `entity` has a `fiducial_return` other than 0.
/// @throws base::InputError for numbers out of range or more than 1000 fiducials
void add_fiducial(BuildState& b, const Entity& entity, const Size& size, const Pose& X_B);

}  // namespace sf::world
