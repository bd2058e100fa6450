#pragma once
// Cost of a world in the farm: tables, kernels and time, measured with one sensor type subscribed at a time.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "sensors/accuracy.h"
#include "world/world.h"

namespace sf::scenarios {

/// Cost of one sensor type of the world.
struct SensorTypeCost {
  std::string type;
  std::uint32_t sensors = 0;
  std::uint32_t robots = 0;                  ///< number of robots with such sensors
  double least_rate = 0.0, most_rate = 0.0;  ///< [Hz]
  std::vector<std::string> kernels;
  std::vector<gpu::DeviceAllocation> tables;  ///< largest first
  std::size_t bytes = 0;                      ///< of all tables
  std::string source;  ///< sensor type whose readings it is computed from, subscribed together with it; empty: none
  std::vector<std::string> inputs;  ///< of a derived type: sensor types that are measured for it alone
  double tick = 0.0;                ///< [s] mean wall time of a tick with this type alone
  double readings = 0.0;            ///< mean number per tick
  double reused = 0.0;              ///< mean number per tick
  sensors::SensorStats work;        ///< sum over all measured ticks
};

/// Number of walls in view of lasers at one height.
struct WallSlice {
  double z = 0.0;  ///< [m]
  std::uint32_t sensors = 0;
  std::size_t walls = 0;
};

struct Explanation {
  std::string caster;  ///< description of the ray caster
  std::vector<SensorTypeCost> types;
  std::vector<std::string> absent;                     ///< sensor types that do not occur in the world
  std::vector<WallSlice> slices;                       ///< by height of the lasers
  std::size_t walls = 0;                               ///< of the world
  std::vector<sensors::AccuracyStatement> statements;  ///< modes and bounds by sensor type
  std::uint64_t ticks = 0;                             ///< measured ticks per row
  double build = 0.0;                                  ///< [s] time to build tables and kernels
  double first = 0.0;                                  ///< [s] first tick with all sensors subscribed
  double silent = 0.0;                                 ///< [s] mean time of a tick without subscription
  double all = 0.0;                                    ///< [s] mean time of a tick with all sensors subscribed
  std::size_t resident = 0;  ///< [bytes] resident memory of the process, driver included; 0: unknown
};

/// Drives the robots with `wander` for two seconds of simulated time. Then ticks a farm along the recorded paths:
/// without subscription, with each sensor type alone, and with all.
/// @param progress called with the completed fraction in (0, 1]; may be empty
/// @throws base::InputError as farm::Farm
Explanation explain(const world::World& world, gpu::Device& device, std::uint64_t seed, unsigned threads,
                    const std::function<void(double)>& progress = {});

}  // namespace sf::scenarios
