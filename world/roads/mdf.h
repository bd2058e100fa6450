#pragma once
// Mission data files: the checkpoints to visit, in order, and the speed limits of segments and zones.

#include <string>
#include <vector>

#include "world/roads/rndf.h"

namespace sf::world {

/// [m/s] one mile per hour
inline constexpr double kMilePerHour = 0.44704;

struct MdfCheckpoint {
  int id = 0;    ///< in [1, 32768]; may occur more than once
  int line = 0;  ///< 1-based
};

/// Invariant: `least_mph <= most_mph`.
struct SpeedLimit {
  int id = 0;              ///< of a segment or a zone, in [1, 32768]
  double least_mph = 0.0;  ///< [mile/h] in [0, 32768]; 0: no minimum
  double most_mph = 0.0;   ///< [mile/h] in [0, 32768]
  int line = 0;            ///< 1-based
};

struct Mdf {
  std::string file;  ///< as given by the user
  std::string name;
  std::string rndf_name;  ///< the mission's network as written: the name of a network or of a file
  std::string format_version;
  std::string creation_date;
  std::vector<MdfCheckpoint> checkpoints;  ///< in visiting order
  std::vector<SpeedLimit> speed_limits;
  std::vector<Warning> warnings;
};

/// Reads a mission and checks its syntax. Problems with an obvious interpretation become warnings; all others are
/// thrown together.
/// @param strict throw the first problem
/// @throws base::InputError with file, line, expected input and advice
Mdf read_mdf(const std::string& file, bool strict = false);

/// Same, from memory. @param file name for errors
Mdf parse_mdf(const std::string& file, std::string_view text, bool strict = false);

/// Checks that the mission can be driven on `rndf`. Speed limits of missing segments or zones become warnings.
/// @throws base::InputError listing all missing checkpoints
std::vector<Warning> check_against(const Mdf& mdf, const Rndf& rndf);

}  // namespace sf::world
