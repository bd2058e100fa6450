#pragma once
// Properties as numbers with units: everything that leaves here is in metres, radians and seconds, finite and within
// reach.

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "world/entities.h"

namespace sf::world {

/// Larger lengths are slips of the pen: beyond, a double no longer resolves a nanometre.
inline constexpr double kMostLength = 1e7;  ///< [m]

/// What a world holds so far of what a few words of its file may ask too much of.
struct Spent {
  double models = 0.0;
  double name_bytes = 0.0;
  double segments = 0.0;
  double corner_pairs = 0.0;  ///< that blocks' outlines are checked by
  double paint_points = 0.0;
  double beams = 0.0;
  double roads = 0.0;
};

/// What every reader of properties needs. The document must outlive it.
struct Source {
  const Document& document;
  double metres = 1.0;            ///< [m] per unit of length of the file (`unit_length`)
  double radians = M_PI / 180.0;  ///< [rad] per unit of angle of the file (`unit_angle`)
  std::vector<Warning> warnings;
  std::set<std::string> warned;  ///< one warning per place and text, however often a macro is used
  Spent spent;
};

/// @throws base::InputError, always, with the file and line of `at`.
[[noreturn]] void fail(const Source& source, Place at, const std::string& message);
/// Of more warnings than a file of ours has lines only the first are kept.
void warn(Source& source, Place at, const std::string& message);

/// Counts `more` of what all the world may have `most` of, before it is made. @param remedy what to do
/// @throws base::InputError where that is too much.
void spend(const Source& source, Place at, double& spent, double more, double most, std::string_view what,
           std::string_view remedy);

/// Where the property is written, or the entity where it has none.
Place place_of(const Entity& entity, std::string_view key);

// Each reads one property of `entity`, or gives the fallback when it is absent.
// @throws base::InputError when it is of another kind, shorter than `least` numbers or out of reach.

double number(const Source& source, const Entity& entity, std::string_view key, double fallback);
double length(const Source& source, const Entity& entity, std::string_view key, double fallback);
/// A length that is more than zero.
double above_zero(const Source& source, const Entity& entity, std::string_view key, double fallback);
double angle(const Source& source, const Entity& entity, std::string_view key, double fallback);
bool flag(const Source& source, const Entity& entity, std::string_view key, bool fallback);
std::string text(const Source& source, const Entity& entity, std::string_view key, const std::string& fallback);

/// `accuracy "word"`; where it is absent, the fallback. An order that holds for all sensors comes before it.
Accuracy accuracy(const Source& source, const LoadOptions& options, const Entity& entity, const Accuracy& fallback);

/// A whole number in [least, most].
std::uint32_t whole(const Source& source, const Entity& entity, std::string_view key, std::uint32_t fallback,
                    std::uint32_t least, std::uint32_t most);

/// The numbers of a tuple as written, at least `least` of them; nothing when the property is absent.
/// @param meaning e.g. "[min max]", for the error.
std::optional<std::vector<double>> tuple(const Source& source, const Entity& entity, std::string_view key,
                                         std::size_t least, const std::string& meaning);

/// `[x y z yaw]`; three numbers are read as [x y z], with a warning.
Pose pose(Source& source, const Entity& entity, std::string_view key);

/// A length of a tuple, checked.
double metres(const Source& source, Place at, double value);

}  // namespace sf::world
