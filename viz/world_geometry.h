#pragma once
// Converts a world and its recorded runs to geometry for VTK (viz/vtk_files.h). All [m], world frame, z up.

#include <span>
#include <vector>

#include "base/reading.h"
#include "base/tilted_pose.h"
#include "sensors/magnetic_field/records.h"
#include "sensors/sensor_type.h"
#include "viz/tracks.h"
#include "viz/vtk_files.h"
#include "world/world.h"

namespace sf::viz {

/// Triangles of meshes beyond this number, over all their places, are not drawn: their outlines are.
inline constexpr std::size_t kMostDrawnTriangles = 2'000'000;
inline constexpr std::size_t kMostTerrainTriangles = 500'000;  ///< terrain is drawn in larger cells beyond this number

/// Returns one upright rectangle per wall segment, and the tops and bottoms of closed outlines in convex pieces
/// (bottoms above the floor only), or the triangles of a model that has a mesh. Cell arrays: `model` (row of the
/// world's models), `height` [m], `rgb` [0, 255]; `laser` and `robots` are 1 if lasers see the wall or robots stop at
/// it; `name` of the model. `model` of terrain is -1.
PolyData walls_geometry(const world::World& world);

/// Returns lane markings and paths as lines on the ground. Cell arrays: `width` [m], `rgb` [0, 255], `kind`: 0 marking,
/// 1 path.
PolyData roads_geometry(const world::World& world);

/// Returns the tops, bottoms and sides of the bodies of movers, or the triangles of models that have a mesh, at
/// `poses`, one per mover of the world; absent movers are omitted. Cell arrays: `robot` (row of the world's movers),
/// `rgb`; `name`.
PolyData bodies_geometry(const world::World& world, std::span<const base::TiltedPose> poses);

/// Returns the states of traffic lights, one per light of the world: on top of each head an indicator, and on its front
/// a lamp, at the height of its colour if the head has three. They are half as large while a light flashes. Cell
/// arrays: `light` (row of the world's lights), `rgb`; `name`.
PolyData lights_geometry(const world::World& world, std::span<const world::LightState> states);

/// A mover's state at one tick.
struct MotionSample {
  double time = 0.0;  ///< [s]
  base::Pose X_WM;
  double speed = 0.0;  ///< [m/s]
  bool contact = false;
};
/// Returns one line per robot, with gaps while it is absent. Point arrays: `time` [s], `speed` [m/s], `yaw` [rad],
/// `contact`; cell array: `robot`; `name`.
PolyData trajectories_geometry(const world::World& world, std::span<const std::vector<MotionSample>> motions);

/// Collects scans, tilted with their robots and mounts, as dots at the ends of their beams, or as the beams. Point
/// arrays: `range` [m], `bearing` [rad], `hit` (row of the model that was hit; -1: none in range, -2: the floor or
/// terrain), `bound` [m] (largest error; infinite: not stated), `robot`, `sensor`, `time` [s].
class ScanGeometry {
 public:
  explicit ScanGeometry(bool beams) : beams_(beams) {}
  /// @param laser of the scan  @param X_MS its pose in the robot's frame (sensors::laser_mount)
  void add(const sensors::SensorSpec& laser, const base::RigidTransform& X_MS, const base::ReadingBlock& scan);
  const PolyData& data() const { return data_; }

 private:
  bool beams_;
  PolyData data_;
};

}  // namespace sf::viz
