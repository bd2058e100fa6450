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

/// Settings of a lane edge sensor beside the common ones.
inline constexpr std::string_view kLaneEdgeKeys[] = {"fov", "samples", "range_max", "range_min", "perpendicular",
                                                     // settings of the thesis' lasers, for drawing
                                                     "laser_color"};

inline constexpr AccuracyMode kLaneEdgeModes[] = {
    {"exact", "a line through the points of all rays"},
    {"skip2", "every 2nd ray"},
    {"skip4", "every 4th ray"},
};

/// True when markings are seen in pixels: no bound is stated then.
bool uses_raster(const world::World& world);
/// [m] largest distance of a point from its edge with exact markings, from rounding. @param longest, farthest see
/// `raycast::exact_bound`
double point_error(const LaneEdge& edge, double longest, double farthest);
/// [m] base::ReadingBlock::bound without noise, with exact markings: 10 nm, more at large coordinates.
double lane_edge_bound(const LaneEdge& edge, double longest, double farthest);
/// The reason for which a distance may exceed `bound` [m], for points with an error up to `error` [m].
base::QualityFlag quality_of(const EdgeReading& reading, double error, double bound);
ErrorBound bound_of_lane_edge(const world::World& world, const SensorSpec& sensor);

/// [-] Fraction of range_max above which ranges are "near the maximum" and not points.
inline constexpr double kNearMaximum = 0.99;
/// [-] Largest extrapolated distance of an edge, as a multiple of range_max.
inline constexpr double kFarthest = 10.0;

extern const SensorType laneedge_type;

/// @throws base::InputError with file and line for an invalid setting
LaneEdge lane_edge_of(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number);

/// All lane edge sensors of a world, by mover and in file order.
std::vector<LaneEdge> lane_edges_of(const world::World& world);

}  // namespace sf::sensors
