#pragma once
// Planar scans of tilted robots, and of robots that move while they scan: each beam cuts the scene of solids, meshes
// and the floor that lidars see. Takes memory only once a robot needs it.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <span>
#include <vector>

#include "base/reading.h"
#include "base/report.h"
#include "scene/beam_pattern.h"
#include "scene/rasterizer.h"
#include "sensors/spatial_scene.h"
#include "world/world.h"

namespace sf::sensors {

/// Beams in the x-y plane of their sensor.
struct PlanarBeams {
  std::vector<glm::dvec3> directions;  ///< unit vectors
  scene::BeamPattern pattern;
};
/// @param times [s] <= 0 of the beams relative to the reading; empty: all 0
PlanarBeams planar_beams(std::span<const double> bearings, std::span<const double> times);

/// One scan, beam by beam.
struct TiltedScan {
  std::vector<double> ranges;              ///< [m], range_max without an echo
  std::vector<std::uint32_t> hits;         ///< as ReadingBlock::hits
  std::vector<base::QualityFlag> quality;  ///< ranges without a flag are within scene::kRangeError
};

class TiltedScans {
 public:
  /// @param reach [m] longest range of the sensors  @param reference casts against every face in `long double`
  /// @throws base::InputError as SpatialScene
  TiltedScans(const world::World& world, double reach, bool reference, unsigned threads);

  void update_movers(const world::World& world) { scene_.update_movers(world); }
  void place(std::span<const base::Report> states) { scene_.place(states); }
  /// @param X_MS the sensor in its mover's frame  @param range_max [m]
  /// @param trails of a rolling scan, whose beams have times; null: all are cast at once
  /// @param thread less than `threads`; each thread uses its own number
  void cast(const PlanarBeams& beams, std::uint32_t mover, const base::RigidTransform& X_MS, double range_max,
            const MoverTrails* trails, unsigned thread, TiltedScan& out);

 private:
  struct Scratch {
    scene::Rasterizer rasterizer;
    SceneList list;
  };
  SpatialScene scene_;
  bool reference_;
  std::vector<Scratch> scratch_;  ///< per thread
};

}  // namespace sf::sensors
