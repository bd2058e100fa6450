#pragma once
// Route network definition files as written: ids, degrees and feet, each with its line. world/roads/network.h has the
// network in metres.
//
//   Rndf roads = read_rndf("site.rndf");   // throws base::InputError with file:line
//   count(roads).lanes;

#include <optional>
#include <string>
#include <vector>

#include "world/roads/rndf_statement_reader.h"
#include "world/world.h"

namespace sf::world {

/// Marking along one side of a lane. `none`: not specified in the file.
enum class Boundary : std::uint8_t { none, double_yellow, solid_yellow, solid_white, broken_white };

/// Returns the word in the file; "none" for none.
std::string_view word_of(Boundary boundary);
/// Returns nullopt for a word that is not a boundary; "none" is not a word of the format.
std::optional<Boundary> boundary_of(std::string_view word);
/// Returns `double_yellow, solid_yellow, ...`, for errors.
std::string boundary_words();

struct RndfPoint {
  PointId id;
  double latitude = 0.0;   ///< [deg] in [-90, 90], north positive; ITRF00 on GRS80
  double longitude = 0.0;  ///< [deg] in [-180, 180], east positive
  int line = 0;            ///< 1-based, here and below
};

/// An exit of a lane or a zone, possibly written in the block of another one. Both points are existing way-points of
/// lanes or perimeter points of zones.
struct RndfExit {
  PointId from;
  PointId to;
  int line = 0;
};

struct RndfStop {
  PointId at;  ///< a way-point of a lane
  int line = 0;
};

struct RndfCheckpoint {
  int id = 0;  ///< in [1, 32768], unique in the file
  PointId at;  ///< a way-point of a lane or a point of a spot
  int line = 0;
};

struct RndfLane {
  int number = 0;                  ///< in [1, 32768]
  std::optional<double> width_ft;  ///< [ft] > 0; nullopt if the file has no width or 0
  Boundary left = Boundary::none;
  Boundary right = Boundary::none;
  std::vector<RndfPoint> points;  ///< at least one, in driving direction
  std::vector<RndfExit> exits;
  std::vector<RndfStop> stops;
  std::vector<RndfCheckpoint> checkpoints;
  int line = 0;
};

struct RndfSegment {
  int id = 0;        ///< in [1, 32768], unique among segments and zones
  std::string name;  ///< may be empty or contain blanks
  std::vector<RndfLane> lanes;
  int line = 0;
};

struct RndfSpot {
  int number = 0;                  ///< in [1, 32768]
  std::optional<double> width_ft;  ///< [ft] > 0; nullopt if the file has no width or 0
  std::vector<RndfPoint> points;   ///< two: entry and end
  std::vector<RndfCheckpoint> checkpoints;
  int line = 0;
};

struct RndfZone {
  int id = 0;                        ///< in [1, 32768], unique among segments and zones
  std::string name;                  ///< may be empty or contain blanks
  std::vector<RndfPoint> perimeter;  ///< closed: the last point is connected to the first; at least one
  std::vector<RndfExit> exits;
  std::vector<RndfSpot> spots;
  int line = 0;
};

struct Rndf {
  std::string file;  ///< as given by the user
  std::string name;
  std::string format_version;
  std::string creation_date;
  std::vector<RndfSegment> segments;  ///< in file order, like all lists here
  std::vector<RndfZone> zones;
  std::vector<Warning> warnings;
};

struct RoadCounts {
  std::size_t segments = 0;
  std::size_t lanes = 0;
  std::size_t zones = 0;
  std::size_t spots = 0;
  std::size_t lane_waypoints = 0;
  std::size_t points = 0;  ///< way-points of lanes, perimeter points and points of spots
  std::size_t exits = 0;   ///< of lanes and zones
  std::size_t stops = 0;
  std::size_t checkpoints = 0;  ///< on lanes and in spots
};
RoadCounts count(const Rndf& rndf);

/// Reads a file and checks its syntax and all its references. Problems with an obvious interpretation become warnings;
/// all others are thrown together.
/// @param strict throw the first problem
/// @throws base::InputError with file, line, expected input and advice
Rndf read_rndf(const std::string& file, bool strict = false);

/// Same, from memory. @param file name for errors
Rndf parse_rndf(const std::string& file, std::string_view text, bool strict = false);

}  // namespace sf::world
