#pragma once
// Route network definition files as they are written: ids, degrees, feet, each with its line. What they mean in metres
// is world/roads/network.h.
//
//   Rndf roads = read_rndf("site.rndf");   // throws base::InputError with file:line
//   count(roads).lanes;

#include <optional>
#include <string>
#include <vector>

#include "world/roads/rndf_statement_reader.h"
#include "world/world.h"

namespace sf::world {

/// What is painted along one side of a lane. `none`: the file says nothing.
enum class Boundary : std::uint8_t { none, double_yellow, solid_yellow, solid_white, broken_white };

/// The file's word for it; "none" for none.
std::string_view word_of(Boundary boundary);
/// Nothing for a word that is no boundary; "none" is not one of the file's words.
std::optional<Boundary> boundary_of(std::string_view word);
/// `double_yellow, solid_yellow, ...`: for errors.
std::string boundary_words();

struct RndfPoint {
  PointId id;
  double latitude = 0.0;   ///< [deg] in [-90, 90], north positive; ITRF00 on GRS80
  double longitude = 0.0;  ///< [deg] in [-180, 180], east positive
  int line = 0;            ///< 1-based, here and below
};

/// A way out of a lane or a zone, and not always the one that it is listed under. Both points are way-points of lanes
/// or perimeter points of zones that exist.
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
  std::optional<double> width_ft;  ///< [ft] > 0; nothing where the file says nothing or 0
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
  std::string name;  ///< may be empty or hold blanks
  std::vector<RndfLane> lanes;
  int line = 0;
};

struct RndfSpot {
  int number = 0;                  ///< in [1, 32768]
  std::optional<double> width_ft;  ///< [ft] > 0; nothing where the file says nothing or 0
  std::vector<RndfPoint> points;   ///< two: where it is entered, where it ends
  std::vector<RndfCheckpoint> checkpoints;
  int line = 0;
};

struct RndfZone {
  int id = 0;                        ///< in [1, 32768], unique among segments and zones
  std::string name;                  ///< may be empty or hold blanks
  std::vector<RndfPoint> perimeter;  ///< closed: the last is joined to the first; at least one
  std::vector<RndfExit> exits;
  std::vector<RndfSpot> spots;
  int line = 0;
};

struct Rndf {
  std::string file;  ///< as given by the user
  std::string name;
  std::string format_version;
  std::string creation_date;
  std::vector<RndfSegment> segments;  ///< in file order, as everything else
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

/// Reads a file, checks its form and every reference in it. What is wrong but clear becomes a warning; all that has no
/// clear meaning is thrown at once.
/// @param strict the first thing that is wrong is thrown.
/// @throws base::InputError with file, line, what was expected and what to do.
Rndf read_rndf(const std::string& file, bool strict = false);

/// Likewise from memory; `file` names errors.
Rndf parse_rndf(const std::string& file, std::string_view text, bool strict = false);

}  // namespace sf::world
