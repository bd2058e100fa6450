#pragma once
// A world under construction from its file's tree.

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "world/keys.h"
#include "world/meshes/triangles.h"
#include "world/stage/model_shape.h"
#include "world/stage/properties.h"

namespace sf::world {

/// The frame and names that a model passes to its children.
struct Parent {
  std::uint32_t model = kNone;
  std::uint32_t mover = kNone;
  Pose X_WP;          ///< pose of the parent in the world
  Pose X_MP;          ///< pose of the parent in its mover's frame, if it has a mover
  double lift = 0.0;  ///< [m] the parent's height, if it stacks its children
  std::string name;
  std::string name_in_mover;                     ///< empty for the mover itself
  std::map<std::string, std::uint32_t> unnamed;  ///< per word: number of children without a name
  const SensorKeyword* sensor = nullptr;         ///< the parent's sensor type; null: no sensor
};

/// A mesh as a model shows it: its file, and numbers of its rotation, scale and box.
using MeshKey = std::pair<std::string, std::array<double, 10>>;

struct MeshRow {
  std::uint32_t row = 0;  ///< in `World::meshes`
  Size size;              ///< above the model's foot
};

struct BuildState {
  const LoadOptions& options;
  StageContext context;
  World world;
  BitmapCache bitmaps;
  std::map<std::string, Triangles> triangles;  ///< of files of meshes
  std::map<MeshKey, MeshRow> mesh_rows;
  std::map<std::uint32_t, std::vector<Segment>> mesh_outlines;  ///< per row of `World::meshes`, from above
  std::set<std::string> names;
  std::map<std::string, int> copies;                  ///< last number used for models with the same name
  std::set<std::string> warned_types;                 ///< types already warned about
  std::vector<std::optional<std::uint32_t>> numbers;  ///< per mover: the number in its name
  std::vector<SourceLocation> locations;              ///< per mover: its place in the file
  std::vector<std::string_view> types;                ///< every type and macro, for suggestions
  std::vector<SourceLocation> light_locations;        ///< per light: the place of its way-points in the file
  std::map<std::string, bool> way_points;             ///< of all road networks; true: with a stop line
};

/// Returns `wanted`, or `wanted#2`, `wanted#3`, ...: a name that no other model has.
std::string free_name(BuildState& b, const std::string& wanted);

/// Adds the children of `entity` and their descendants as models. Warns about entities in the wrong place.
/// @throws base::InputError with file and line
void add_children(BuildState& b, const Entity& entity, Parent& parent);

/// Warns about properties that are unknown in `where`, suggesting the nearest known key.
/// @param own further keys known there
void check_keys(StageContext& context, const Entity& entity, KeyScope where,
                std::span<const std::string_view> own = {});

}  // namespace sf::world
