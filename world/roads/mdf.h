#pragma once
// Mission data files: which checkpoints to visit in which order, and how fast to drive where.

#include <string>
#include <vector>

#include "world/roads/rndf.h"

namespace sf::world {

/// [m/s] of a mile per hour.
inline constexpr double kMilePerHour = 0.44704;

struct MdfCheckpoint {
  int id = 0;    ///< in [1, 32768]; may come more than once
  int line = 0;  ///< 1-based
};

/// Rule: `least_mph <= most_mph`.
struct SpeedLimit {
  int id = 0;              ///< of a segment or a zone, in [1, 32768]
  double least_mph = 0.0;  ///< [mile/h] in [0, 32768]; 0: no minimum
  double most_mph = 0.0;   ///< [mile/h] in [0, 32768]
  int line = 0;            ///< 1-based
};

struct Mdf {
  std::string file;  ///< as given by the user
  std::string name;
  std::string rndf_name;  ///< of the network it was made for, as written; a name or a file's name
  std::string format_version;
  std::string creation_date;
  std::vector<MdfCheckpoint> checkpoints;  ///< in the order to visit
  std::vector<SpeedLimit> speed_limits;
  std::vector<Warning> warnings;
};

/// Reads a mission and checks its form. What is wrong but clear becomes a warning; all that has no clear meaning is
/// thrown at once.
/// @param strict the first thing that is wrong is thrown.
/// @throws base::InputError with file, line, what was expected and what to do.
Mdf read_mdf(const std::string& file, bool strict = false);

/// Likewise from memory; `file` names errors.
Mdf parse_mdf(const std::string& file, std::string_view text, bool strict = false);

/// Checks that the mission can be driven on `rndf`. Speed limits for segments or zones that it has not are warnings.
/// @throws base::InputError for all checkpoints that do not exist.
std::vector<Warning> check_against(const Mdf& mdf, const Rndf& rndf);

}  // namespace sf::world
