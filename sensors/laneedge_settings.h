#pragma once
// What a world file may say of a lane edge sensor.

#include <vector>

#include "sensors/laneedge.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// One lane edge sensor as it was set up.
struct LaneEdge {
  SensorSpec row;
  world::Laser fan;           ///< its rays; X_MS at half of the model's height
  glm::dvec2 perpendicular;   ///< unit vector in the sensor's frame along which the distance is meant
  bool single = false;        ///< one or two rays: the first one's range is the reading
  double distance_max = 0.0;  ///< [m] an edge farther away is out of sight
};

/// Settings of a lane edge sensor, beside those of all sensors.
inline constexpr std::string_view kLaneEdgeKeys[] = {"fov", "samples", "range_max", "range_min", "perpendicular",
                                                     // of the thesis' lasers, for drawing
                                                     "laser_color"};

inline constexpr AccuracyMode kLaneEdgeModes[] = {
    {"exact", "a line through the points of all rays"},
    {"skip2", "every 2nd ray"},
    {"skip4", "every 4th ray"},
};

/// Whether stripes are seen in pixels: then no bound is stated.
bool uses_raster(const world::World& world);
/// [m] how far a point of exact paint may lie off its face, across it: rounding. @param longest, farthest see
/// `raycast::exact_bound`
double point_error(const LaneEdge& edge, double longest, double farthest);
/// [m] base::ReadingBlock::bound without noise, in exact paint: 10 nm, more far away.
double lane_edge_bound(const LaneEdge& edge, double longest, double farthest);
/// Why a line's distance may be off by more than `bound` [m], its points being off by up to `error` [m].
base::QualityFlag quality_of(const EdgeReading& reading, double error, double bound);
ErrorBound bound_of_lane_edge(const world::World& world, const SensorSpec& sensor);

/// A share of range_max: ranges from here on are "near the maximum" and no points.
inline constexpr double kNearMaximum = 0.99;
/// Most that an edge's distance may exceed range_max by extrapolation.
inline constexpr double kFarthest = 10.0;

extern const SensorType laneedge_type;

/// @throws base::InputError with file and line for a setting that it cannot have.
LaneEdge lane_edge_of(const world::Sensor& sensor, std::uint32_t mover, std::uint32_t number);

/// All of a world, by mover and in file order.
std::vector<LaneEdge> lane_edges_of(const world::World& world);

}  // namespace sf::sensors
