#pragma once
// World-file settings of a lane edge sensor.

#include <vector>

#include "raycast/beams.h"
#include "sensors/laneedge.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// Settings of one lane edge sensor.
struct LaneEdge {
  SensorSpec row;
  raycast::ScanSettings fan;  ///< its beams; X_MS at half the model's height
  glm::dvec2 perpendicular;   ///< unit vector in the sensor frame: the direction of the distance
  bool single = false;        ///< one or two beams: the first one's range is the reading
  double distance_max = 0.0;  ///< [m] a farther edge is out of sight
};

/// Keys of a lane edge sensor, in addition to the common ones.
inline constexpr std::string_view kLaneEdgeKeys[] = {"fov", "samples", "range_max", "range_min", "noise",
                                                     "perpendicular",
                                                     // settings of the thesis' lasers, for drawing
                                                     "laser_color"};

inline constexpr AccuracyMode kLaneEdgeModes[] = {
    {"exact", "a line through the points of all rays"},
    {"skip2", "every 2nd ray"},
    {"skip4", "every 4th ray"},
};

/// Returns true when markings are rasterized to pixels. No bound is stated then.
bool uses_raster(const world::World& world);
/// Returns the largest distance [m] of a point from its edge with exact markings, due to rounding. @param longest,
/// farthest see `raycast::exact_bound`
double point_error(const LaneEdge& edge, double longest, double farthest);
/// Returns base::ReadingBlock::bound [m] without noise, with exact markings: 10 nm, more at large coordinates.
double lane_edge_bound(const LaneEdge& edge, double longest, double farthest);
/// Returns the reason why a distance may exceed `bound` [m], for points with an error up to `error` [m].
base::QualityFlag quality_of(const EdgeReading& reading, double error, double bound);
/// Implements `SensorType::bound`.
ErrorBound bound_of_lane_edge(const world::World& world, const ParsedSensors& sensors, std::size_t row);

/// [-] Fraction of range_max above which ranges are "near the maximum" and yield no points.
inline constexpr double kNearMaximum = 0.99;
/// [-] Largest extrapolated distance of an edge, as a multiple of range_max.
inline constexpr double kFarthest = 10.0;

extern const SensorType laneedge_type;

/// Reads the settings of a sensor. @throws base::InputError with file and line for an invalid setting
LaneEdge lane_edge_of(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number);

/// Returns all lane edge sensors of a world, by mover and in file order.
std::vector<LaneEdge> lane_edges_of(const world::World& world);

}  // namespace sf::sensors
