#pragma once
// The sidecar of an RNDF: its place and scale in the world, and widths finer than feet. A TOML file in the folder of
// the RNDF, `site.toml` for `site.rndf`; docs/roads.md lists the keys.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "world/roads/geodesy.h"
#include "world/roads/rndf.h"

namespace sf::world {

/// Lengths are in world metres, after scaling. nullopt: not specified.
struct RoadSidecar {
  struct Lane {
    std::optional<double> width;  ///< [m] in [1e-6, 10 000]
    std::optional<Boundary> left;
    std::optional<Boundary> right;
    int line = 0;
  };
  struct Point {
    std::optional<glm::dvec2> p;  ///< [m] world frame, overrides latitude and longitude
    double height = 0.0;          ///< [m] above the floor, in [0, 1000]; 0 for points of zones and spots
    int line = 0;
  };

  std::string file;                  ///< empty: no sidecar
  std::optional<Geodetic> origin;    ///< nullopt: the network's first point
  double scale = 1.0;                ///< [-] metres of the world per metre of the RNDF, in [1e-6, 1000]
  glm::dvec2 position;               ///< [m] position of the origin in the world
  double heading = 0.0;              ///< [rad] direction of the RNDF's east in the world, counter-clockwise from +x
  std::optional<double> lane_width;  ///< [m] width of lanes without a width in `lanes`
  std::optional<double> paint_width;
  std::optional<double> dash_length;
  std::optional<double> dash_gap;
  std::optional<double> stop_width;  ///< [m] width of stop lines, along the lane
  std::optional<double> spot_width;  ///< [m] width of every parking spot
  std::map<PointId, Lane> lanes;     ///< by {segment, lane, 0}
  std::map<PointId, Point> points;
};

/// Reads the sidecar of `rndf_file`; returns the defaults if there is no such file. Unknown keys become warnings.
/// @throws base::InputError with file and line
RoadSidecar read_sidecar(const std::string& rndf_file, std::vector<Warning>& warnings);

/// Same, from memory. @param file name for errors
RoadSidecar parse_sidecar(const std::string& file, std::string_view text, std::vector<Warning>& warnings);

/// Checks that all lanes and points of the sidecar exist in `rndf`. @throws base::InputError
void check_against(const RoadSidecar& sidecar, const Rndf& rndf);

}  // namespace sf::world
