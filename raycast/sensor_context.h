#pragma once
// What a caster is given, what it is asked for, and what it did.

#include <cstdint>

#include "base/thread_pool.h"
#include "gpu/device.h"
#include "raycast/scene_options.h"
#include "world/world.h"

namespace sf::raycast {

using base::Pose;

/// One sensor that is due.
struct DueSample {
  std::uint32_t row = 0;       ///< in the kind's rows of this world
  std::uint64_t sequence = 0;  ///< counts this sensor's readings; names its noise
};

/// What instruments of all kinds are given. All of it outlives them.
struct SensorContext {
  const world::World& world;
  gpu::Device& device;
  base::ThreadPool& thread_pool;
  std::uint64_t seed = 0;  ///< of all noise
  bool noise = true;       ///< false: none, whatever the world says
  bool true_poses = true;  ///< movers are where their reports say: a simulation; false: these are estimates
  SceneOptions scene;
};

/// What instruments did since they were made.
struct SensorStats {
  std::uint64_t rays = 0;             ///< beams cast
  std::uint64_t uncertain = 0;        ///< beams that 32 bits could not prove
  std::uint64_t cells_built = 0;      ///< sector lists made
  std::uint64_t dipoles = 0;          ///< magnet and element pairs summed
  std::uint64_t movers_in_range = 0;  ///< pairs of a robot that looks and a mover within its range
  std::uint64_t movers_visible = 0;   ///< of these, in view; on the host, not hidden by nearer movers or walls either
  std::uint64_t host_scans = 0;       ///< fans of beams cast on the host: too many surfaces for the device's lists

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
