#pragma once
// Properties as numbers with units: everything that leaves here is in metres, radians and seconds, finite and within
// reach.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "world/stage/document.h"

namespace sf::world {

/// Larger lengths are slips of the pen: beyond, a double no longer resolves a nanometre.
inline constexpr double kMaxLength = 1e7;  ///< [m]

/// What a world holds so far of what a few words of its file may ask too much of.
struct ResourceUsage {
  double models = 0.0;
  double name_bytes = 0.0;
  double segments = 0.0;
  double corner_pairs = 0.0;  ///< that blocks' outlines are checked by
  double paint_points = 0.0;
  double beams = 0.0;
  double roads = 0.0;
};

/// What every reader of properties needs. The document must outlive it.
struct StageContext {
  const Document& document;
  double metres_per_unit = 1.0;            ///< [m] per unit of length of the file (`unit_length`)
  double radians_per_unit = M_PI / 180.0;  ///< [rad] per unit of angle of the file (`unit_angle`)
  std::vector<Warning> warnings;
  std::set<std::string> warned;  ///< one warning per place and text, however often a macro is used
  ResourceUsage usage;
};

/// @throws base::InputError, always, with the file and line of `at`.
[[noreturn]] void fail(const StageContext& context, SourceLocation at, const std::string& message);
/// Of more warnings than a file of ours has lines only the first are kept.
void warn(StageContext& context, SourceLocation at, const std::string& message);

/// Counts `more` of what all the world may have `most` of, before it is made. @param remedy what to do
/// @throws base::InputError where that is too much.
void charge(const StageContext& context, SourceLocation at, double& used, double more, double most,
            std::string_view what, std::string_view remedy);

/// Where the property is written, or the entity where it has none.
SourceLocation location_of(const Entity& entity, std::string_view key);

// Each reads one property of `entity`, or gives the fallback when it is absent.
// @throws base::InputError when it is of another kind, shorter than `least` numbers or out of reach.

double number(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
double length(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
/// A length that is more than zero.
double above_zero(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
double angle(const StageContext& context, const Entity& entity, std::string_view key, double fallback);
bool flag(const StageContext& context, const Entity& entity, std::string_view key, bool fallback);
std::string text(const StageContext& context, const Entity& entity, std::string_view key, const std::string& fallback);

/// `accuracy "word"`; where it is absent, the fallback. An order that holds for all sensors comes before it.
Accuracy accuracy(const StageContext& context, const LoadOptions& options, const Entity& entity,
                  const Accuracy& fallback);

/// A whole number in [least, most].
std::uint32_t whole(const StageContext& context, const Entity& entity, std::string_view key, std::uint32_t fallback,
                    std::uint32_t least, std::uint32_t most);

/// The numbers of a tuple as written, at least `least` of them; nothing when the property is absent.
/// @param meaning e.g. "[min max]", for the error.
std::optional<std::vector<double>> tuple(const StageContext& context, const Entity& entity, std::string_view key,
                                         std::size_t least, const std::string& meaning);

/// `[x y z yaw]`; three numbers are read as [x y z], with a warning.
Pose pose(StageContext& context, const Entity& entity, std::string_view key);

/// A length of a tuple, checked.
double to_metres(const StageContext& context, SourceLocation at, double value);

}  // namespace sf::world
