#pragma once
// Reads properties as numbers with units. All results are in metres, radians and seconds, finite and in range.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "world/stage/document.h"

namespace sf::world {

/// Largest accepted length: beyond it, a double no longer resolves a nanometre.
inline constexpr double kMaxLength = 1e7;  ///< [m]

/// Resources used so far, limited because a short file can request too many.
struct ResourceUsage {
  double models = 0.0;
  double name_bytes = 0.0;
  double segments = 0.0;
  double triangles = 0.0;     ///< of meshes
  double corner_pairs = 0.0;  ///< pairs of corners compared in the checks of blocks' outlines
  double paint_points = 0.0;
  double samples = 0.0;
  double roads = 0.0;
};

/// A rule of Stage that differs from the default.
struct StageRule {
  bool applies = false;
  bool stated = false;  ///< set by the user or the file, so no warning about the difference is needed
};

/// Context of all property readers. The document must outlive it.
struct StageContext {
  const Document& document;
  double metres_per_unit = 1.0;            ///< [m] per unit of length of the file (`unit_length`)
  double radians_per_unit = M_PI / 180.0;  ///< [rad] per unit of angle of the file (`unit_angle`)
  bool old_shapes = false;  ///< bodies as in versions up to 0.2 (`old_shapes` of the world, docs/worlds.md)
  StageRule obstacles;      ///< floor plans with `obstacle_return 0` do not stop robots
  StageRule noise;          ///< the first number of a ranger's `noise` is a variance
  std::vector<Warning> warnings;
  std::set<std::string> warned;            ///< one warning per place and text, even for a macro used many times
  std::set<std::string_view> differences;  ///< differences from Stage mentioned so far
  ResourceUsage usage;
};

/// Throws base::InputError with the file and line of `at`.
[[noreturn]] void fail(const StageContext& context, SourceLocation at, const std::string& message);
/// Adds a warning. Keeps at most 10 000 warnings.
void warn(StageContext& context, SourceLocation at, const std::string& message);

/// Adds a warning about a difference from Stage, once per world.
void warn_once(StageContext& context, SourceLocation at, std::string_view difference);

/// Adds `more` to `used` before the resource is created.
/// @param remedy advice for the error
/// @throws base::InputError if the total exceeds `most`
void charge(const StageContext& context, SourceLocation at, double& used, double more, double most,
            std::string_view what, std::string_view remedy);

/// Returns the place of the property, or of the entity if it has no such property.
SourceLocation location_of(const Entity& entity, std::string_view key);

// Each function reads one property of `entity`, or returns the fallback if it is absent.
// @throws base::InputError if it has another type, fewer than `least` numbers, or is out of range

double number(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
double length(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
/// Reads a length above zero.
double above_zero(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
bool flag(const StageContext& context, const Entity& entity, std::string_view key, bool fallback);
std::string text(const StageContext& context, const Entity& entity, std::string_view key, const std::string& fallback);

/// Returns the path of the file named by the property. @throws base::InputError if there is none
std::string file_of(const StageContext& context, const Entity& entity, std::string_view key);

/// Returns `LoadOptions::accuracy`, or else `accuracy "word"`, or else no request.
Accuracy accuracy(const StageContext& context, const LoadOptions& options, const Entity& entity);

/// Reads an integer in [least, most].
std::uint32_t whole(const StageContext& context, const Entity& entity, std::string_view key, std::uint32_t fallback,
                    std::uint32_t least, std::uint32_t most);

/// Reads the numbers of a tuple as written, at least `least` of them; nullopt if the property is absent. Numbers beyond
/// those that `meaning` names are kept, with a warning, because Stage ignores them.
/// @param meaning e.g. "[min max]", for messages
std::optional<std::vector<double>> tuple(StageContext& context, const Entity& entity, std::string_view key,
                                         std::size_t least, const std::string& meaning);

/// Reads `[x y z yaw]`. Three numbers are read as [x y z], with a warning.
Pose pose(StageContext& context, const Entity& entity, std::string_view key);

/// Converts a length of a tuple to metres and checks its range.
double to_metres(const StageContext& context, SourceLocation at, double value);

}  // namespace sf::world
