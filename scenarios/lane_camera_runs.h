#pragma once
// Runs of one car that keeps its lane in SimVille, by a lane edge sensor or by a camera, against the true lane.

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "gpu/device.h"
#include "scenarios/scenario.h"
#include "world/roads/curve.h"

namespace sf::scenarios {

/// One way to keep the lane.
struct LaneVariant {
  std::string_view name;
  std::string_view keys = {};  ///< properties of the camera, as in world files, in place of those of the world
  bool camera = true;          ///< else by the lane edge sensor
  bool fast = false;           ///< at 0.5 m/s, else at the scenario's speed
  bool lap = false;            ///< the whole ring with its crossings, which have no paint; else its first lane
  bool drawn = false;          ///< in the figure of the experiment
};
std::span<const LaneVariant> lane_variants();

/// Samples of one run, at the controller's steps.
struct LaneRun {
  std::vector<double> s;         ///< [m] of the robot's origin along the middle of the lane
  std::vector<double> offsets;   ///< [m] of the origin from the middle, to the left
  std::vector<double> headings;  ///< [rad] relative to the lane
  std::vector<double> errors;    ///< [m] of the measured offset ahead of the robot, on the lane; NaN: none was measured
  bool left_lane = false;        ///< the origin crossed an edge: the run ended there
  bool arrived = false;          ///< at the end of the lane
  double seconds = 0.0;          ///< simulated
};

/// The middle of the ring's lanes.
struct LaneCourse {
  world::Curve middle;      ///< without tangents and knots
  double first_lane = 0.0;  ///< [m] length of the first one
};
/// @throws base::InputError if the world has no such lanes
LaneCourse lane_course(const world::World& world);
/// Returns the pose of the lane's frame at `s` [m] along the course, within it.
base::Pose pose_on(const LaneCourse& course, double s);
/// Returns the offset [m] of the lane's middle to the left of a point `ahead` [m] of a robot, along its y axis.
double lane_error(const LaneCourse& course, const base::Pose& X_WM, double ahead = 0.225);

/// The world's changes for one variant: its sensor alone, with the disturbance of the scenario's seed.
/// @throws base::InputError without a car `probe`
world::World lane_world(const Scenario& scenario, const LaneVariant& variant);
std::uint32_t probe_of(const world::World& world);

/// @param scenario with a car `probe`; its seed is that of the run
/// @param stop polled each tick; throws Interrupted if it returns true; may be empty
LaneRun run_lane(const Scenario& scenario, const LaneVariant& variant, gpu::Device& device, unsigned threads,
                 const std::function<bool()>& stop);

}  // namespace sf::scenarios
