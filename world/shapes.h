#pragma once
// Changes of objects' outlines, sizes and colours while a world is in use.
//
//   change_shape(world, mover, {.shape = "crate", .color = 0xFFFF0000u});
//   change_shape(world, mover, {.shape = "original"});   // with its original size and colour
//
// A change affects the mover's own outline, not the models and sensors on it. A new shape replaces the outline and the
// mesh, and brings its own height ranges, size and colour; it keeps the model's `origin`. A new size scales the outline
// and the mesh, by a factor that is exact for boxes and rounded for other outlines.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/shape_state.h"
#include "world/world.h"

namespace sf::world {

inline constexpr std::size_t kMostShapes = 200;                 ///< of one world
inline constexpr std::size_t kMostShapeSides = 10'000;          ///< of one shape
inline constexpr std::size_t kMostChangedSides = 2'000'000;     ///< and triangles, of all movers with changed shapes
inline constexpr std::string_view kOriginalShape = "original";  ///< name of each object's own shape

/// What to change; the rest remains. A new shape brings its own size and colour.
struct ShapeChange {
  std::optional<std::string> shape = {};    ///< name of a shape of the world, or kOriginalShape: with size and colour
  std::optional<std::uint32_t> color = {};  ///< 0xAARRGGBB
  std::optional<glm::dvec3> size = {};      ///< [m] in (0, base::kMostShapeSize] each

  bool any() const { return shape || color || size; }
  /// Adds a later change. A new shape brings its own size and colour, so earlier ones are dropped.
  void add(const ShapeChange& later);
};

/// Returns the colour (0xAARRGGBB) of an X11 name such as "steel blue", or of "#RRGGBB".
/// @throws base::InputError for other texts
std::uint32_t color_named(const std::string& text);

/// @throws base::InputError, in one line, for an unknown shape, a size out of range, a size of an object without an
/// outline of its own, and for more than kMostChangedSides
void check_change(const World& world, std::uint32_t mover, const ShapeChange& change);

/// Returns false for a mover that was given another shape or size than in the file.
bool has_own_shape(const World& world, std::uint32_t mover);

/// Change of the size of an outline or mesh, about the origin of its frame.
struct Stretch {
  glm::dvec3 from{}, to{};  ///< [m]

  bool any() const { return from != to; }
  glm::dvec3 operator()(const glm::dvec3& p) const;
};
/// Returns how the mover's own mesh was stretched since the world was loaded, or nullopt if it has another shape.
std::optional<Stretch> stretch_of(const World& world, std::uint32_t mover);

/// Changes a mover in the world's tables: body, radius, magnets, fiducials, and the model's size and colour. Does not
/// update extent and hash. Tables built from the world must be updated: farm::Farm::update_outlines,
/// robots::Fleet::update_outline.
/// @return whether the outline changed, and not only the colour
/// @throws as check_change, with nothing changed
bool change_shape(World& world, std::uint32_t mover, const ShapeChange& change);

/// Returns the mover's current shape.
base::ShapeState shape_state(const World& world, std::uint32_t mover);

/// Gives a mover a recorded shape.
/// @return as change_shape
/// @throws base::InputError for a row that does not exist and for numbers out of range, with nothing changed
bool restore_shape(World& world, const base::ShapeState& state);

/// Gives all movers their original shapes. @return the states of those that had another
std::vector<base::ShapeState> restore_originals(World& world);

/// Gives a copy of a mover the original shape that `original` of `from` has.
/// @pre `copy` is a copy of that mover, also of its current shape
void restore_copy(World& world, std::uint32_t copy, const World& from, std::uint32_t original);

/// Gives `mover`, a copy of `original`, the original's own outline scaled from size `from` to size `to` [m], about its
/// `origin`. What it carries keeps its place. Updates its radius; not for movers with magnets or fiducials.
void resize(Mover& mover, const Mover& original, const glm::dvec3& from, const glm::dvec3& to);

/// [m] Returns the size of the mover's own outline as loaded; z: from its foot to its top.
glm::dvec3 size_of(const World& world, const Mover& mover);

/// Appends `outline` at `X`, with the model and flags of `surface`. Leaves out sides that vanish by rounding.
void place_outline(std::span<const Segment> outline, const Pose& X, const Segment& surface,
                   std::vector<Segment>& segments);

}  // namespace sf::world
