#pragma once
// Inputs of casters and sensor backends (context, due samples) and their counters.

#include <cstdint>
#include <span>

#include "base/report.h"
#include "base/thread_pool.h"
#include "gpu/device.h"
#include "raycast/episodes.h"
#include "raycast/scene_options.h"
#include "world/world.h"

namespace sf::raycast {

using base::Pose;

/// One due sensor.
struct DueSample {
  std::uint32_t row = 0;       ///< index among the world's sensors of one type
  std::uint64_t sequence = 0;  ///< number of the reading; key of its noise
};

/// Context of sensor backends of all types. All referenced objects must outlive the backends.
struct SensorContext {
  const world::World& world;
  gpu::Device& device;
  base::ThreadPool& thread_pool;
  std::span<const base::Report> states;  ///< one per mover, used for sensing in this tick; refers to the farm's memory
  Episodes episodes;                     ///< of all noise
  bool noise = true;                     ///< false disables noise regardless of the world file
  bool true_poses = true;                ///< true: reported poses are true (simulation); false: they are estimates
  SceneOptions scene;
};

/// Counters of a backend since its construction.
struct SensorStats {
  std::uint64_t rays = 0;             ///< beams cast
  std::uint64_t uncertain = 0;        ///< beams that 32 bits could not certify
  std::uint64_t cells_built = 0;      ///< cells for which lists were built
  std::uint64_t dipoles = 0;          ///< summed pairs of a magnet and an element
  std::uint64_t movers_in_range = 0;  ///< pairs of a sensing robot and a mover within its range
  std::uint64_t movers_visible =
      0;                         ///< of these, pairs in view; on the host, also not hidden by nearer movers or walls
  std::uint64_t host_scans = 0;  ///< scans that the device could not take

  SensorStats& operator+=(const SensorStats& more);
  SensorStats operator-(const SensorStats& before) const;
};

inline SensorStats& SensorStats::operator+=(const SensorStats& more) {
  rays += more.rays, uncertain += more.uncertain, cells_built += more.cells_built, dipoles += more.dipoles;
  movers_in_range += more.movers_in_range, movers_visible += more.movers_visible, host_scans += more.host_scans;
  return *this;
}

inline SensorStats SensorStats::operator-(const SensorStats& before) const {
  return {rays - before.rays,
          uncertain - before.uncertain,
          cells_built - before.cells_built,
          dipoles - before.dipoles,
          movers_in_range - before.movers_in_range,
          movers_visible - before.movers_visible,
          host_scans - before.host_scans};
}

}  // namespace sf::raycast
