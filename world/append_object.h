#pragma once
// Copies of objects and lights, appended to a world after it was loaded, each as a mover (`serve --join`).

#include <cstdint>
#include <span>
#include <string>

#include "world/world.h"

namespace sf::world {

enum class JoiningKind : std::uint8_t { robot, object, light };

/// The model of which copies may join.
struct JoiningTemplate {
  JoiningKind kind = JoiningKind::robot;
  std::uint32_t row = 0;  ///< robot: in `World::movers`; object: in `World::models`; light: in `World::lights`
};

/// Returns the robot, object, light or other model with that name, or else the first robot or object whose type has
/// that word.
/// @throws base::InputError with the names of robots, objects and lights; for a part of a mover; and for a model that
/// cannot move: one without an outline, or with an emitter, a lamp, a heat source, a floor hole or a light of its own
JoiningTemplate joining_template(const World& world, const std::string& name);

/// Returns the number of pieces of a copy's outline.
std::size_t outline_size(const World& world, const JoiningTemplate& of);

/// Appends copies with the ids `ids`, at the place of the original, with names such as box_12. A copy of an object is a
/// tag with its outline, magnets and fiducials; a copy of a light is a tag with the light's post, and a light with its
/// plan and no stop lines, whose intersection has the id. Updates extent and hash.
/// @pre `of` is from `joining_template`, and no copy of the kind has one of the ids
/// @return the first row of `World::movers`
/// @throws base::InputError beyond kMostMovers, or if a name is taken or, of a robot, invalid
std::uint32_t append_joining(World& world, const JoiningTemplate& of, std::span<const std::uint32_t> ids);

}  // namespace sf::world
