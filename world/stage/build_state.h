#pragma once
// A world while it is being built from the tree of its file.

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "world/keys.h"
#include "world/stage/model_shape.h"
#include "world/stage/properties.h"

namespace sf::world {

/// Where the children of a model are put.
struct Parent {
  std::uint32_t model = kNone;
  std::uint32_t mover = kNone;
  Pose X_WP;          ///< the parent in the world
  Pose X_MP;          ///< the parent in its mover's frame, when there is one
  double lift = 0.0;  ///< [m] the parent's height, when it stacks its children
  std::string name;
  std::string name_in_mover;                     ///< empty for the mover itself
  std::map<std::string, std::uint32_t> unnamed;  ///< how many children of each word have no name
};

struct BuildState {
  const LoadOptions& options;
  StageContext context;
  World world;
  BitmapCache bitmaps;
  std::set<std::string> names;
  std::map<std::string, int> copies;                  ///< the last number given to models of one name
  std::set<std::string> warned_types;                 ///< types that were warned about
  std::vector<std::optional<std::uint32_t>> numbers;  ///< per mover: what its name says
  std::vector<SourceLocation> locations;              ///< per mover: where it is written
  std::vector<std::string_view> types;                ///< every type and macro, to suggest from
  std::vector<SourceLocation> light_locations;        ///< per light: where its way-points are written
  std::map<std::string, bool> way_points;             ///< of all road networks; true: with a stop line
};

/// `wanted`, or `wanted#2`, `wanted#3`, ...: a name that no other model has.
std::string free_name(BuildState& b, const std::string& wanted);

/// Adds the children of `entity`, of kind `kind`, and all that is in them: models, and warnings for what belongs
/// elsewhere.
/// @throws base::InputError with file and line.
void add_children(BuildState& b, const Entity& entity, EntityKind kind, Parent& parent);

/// Warns about properties that are not known `where`, with the nearest one that is.
/// @param own further properties known there.
void check_keys(StageContext& context, const Entity& entity, KeyScope where,
                std::span<const std::string_view> own = {});

}  // namespace sf::world
