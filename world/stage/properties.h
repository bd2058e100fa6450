#pragma once
// Properties as numbers with units. All results are in metres, radians and seconds, finite and in range.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "world/stage/document.h"

namespace sf::world {

/// Largest accepted length: beyond it a double no longer resolves a nanometre.
inline constexpr double kMaxLength = 1e7;  ///< [m]

/// Resources used so far, for quantities of which a short file can request too many.
struct ResourceUsage {
  double models = 0.0;
  double name_bytes = 0.0;
  double segments = 0.0;
  double corner_pairs = 0.0;  ///< pairs of corners compared in the checks of blocks' outlines
  double paint_points = 0.0;
  double samples = 0.0;
  double roads = 0.0;
};

/// A rule of Stage's that differs from ours.
struct StageRule {
  bool applies = false;
  bool stated = false;  ///< by the user or the file, so that a difference is no surprise
};

/// Context of all property readers. The document must outlive it.
struct StageContext {
  const Document& document;
  double metres_per_unit = 1.0;            ///< [m] per unit of length of the file (`unit_length`)
  double radians_per_unit = M_PI / 180.0;  ///< [rad] per unit of angle of the file (`unit_angle`)
  bool old_shapes = false;                 ///< bodies as up to version 0.2 (`old_shapes` of the world, docs/worlds.md)
  StageRule obstacles;                     ///< floor plans with `obstacle_return 0` stop no robots
  StageRule noise;                         ///< the first number of a ranger's `noise` is a variance
  std::vector<Warning> warnings;
  std::set<std::string> warned;            ///< one warning per place and text, also for a macro used many times
  std::set<std::string_view> differences;  ///< from Stage, mentioned so far
  ResourceUsage usage;
};

/// @throws base::InputError, always, with the file and line of `at`.
[[noreturn]] void fail(const StageContext& context, SourceLocation at, const std::string& message);
/// Adds a warning. At most 10 000 warnings are kept.
void warn(StageContext& context, SourceLocation at, const std::string& message);

/// Adds a warning about a difference from Stage, once per world.
void warn_once(StageContext& context, SourceLocation at, std::string_view difference);

/// Adds `more` to `used` before the resource is created. @param remedy advice for the error
/// @throws base::InputError when the total exceeds `most`.
void charge(const StageContext& context, SourceLocation at, double& used, double more, double most,
            std::string_view what, std::string_view remedy);

/// The place of the property, or of the entity when it has no such property.
SourceLocation location_of(const Entity& entity, std::string_view key);

// Each function reads one property of `entity`, or returns the fallback when it is absent.
// @throws base::InputError when it is of another kind, shorter than `least` numbers or out of range.

double number(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
double length(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
/// A length above zero.
double above_zero(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
bool flag(const StageContext& context, const Entity& entity, std::string_view key, bool fallback);
std::string text(const StageContext& context, const Entity& entity, std::string_view key, const std::string& fallback);

/// The path of the file that the property names. @throws base::InputError where there is none
std::string file_of(const StageContext& context, const Entity& entity, std::string_view key);

/// `LoadOptions::accuracy`, else `accuracy "word"`, else no request.
Accuracy accuracy(const StageContext& context, const LoadOptions& options, const Entity& entity);

/// A whole number in [least, most].
std::uint32_t whole(const StageContext& context, const Entity& entity, std::string_view key, std::uint32_t fallback,
                    std::uint32_t least, std::uint32_t most);

/// The numbers of a tuple as written, at least `least` of them; nullopt when the property is absent.
/// @param meaning e.g. "[min max]", for errors
std::optional<std::vector<double>> tuple(const StageContext& context, const Entity& entity, std::string_view key,
                                         std::size_t least, const std::string& meaning);

/// `[x y z yaw]`; three numbers are read as [x y z], with a warning.
Pose pose(StageContext& context, const Entity& entity, std::string_view key);

/// A length of a tuple in metres, checked.
double to_metres(const StageContext& context, SourceLocation at, double value);

}  // namespace sf::world
