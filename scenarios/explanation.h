#pragma once
// What a world makes the farm build and do, and what each part of it costs: kinds of sensors are heard one by one.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gpu/device.h"
#include "sensors/accuracy.h"
#include "world/world.h"

namespace sf::scenarios {

/// One kind of sensor that the world has.
struct SensorTypeCost {
  std::string kind;
  std::uint32_t sensors = 0;
  std::uint32_t robots = 0;                  ///< that carry them
  double least_rate = 0.0, most_rate = 0.0;  ///< [Hz]
  std::vector<std::string> kernels;
  std::vector<gpu::DeviceAllocation> tables;  ///< largest first
  std::size_t bytes = 0;                      ///< of all tables
  bool derived = false;                       ///< made of lasers' readings: heard with these
  double tick = 0.0;                          ///< [s] a tick on the clock with this kind heard alone, mean
  double readings = 0.0;                      ///< a tick, mean
  double reused = 0.0;                        ///< of these, given again since nothing they depend on had moved
  sensors::SensorStats work;                  ///< of all measured ticks together
};

/// Walls that lasers and other rays at one height can meet.
struct WallSlice {
  double z = 0.0;  ///< [m]
  std::uint32_t sensors = 0;
  std::size_t walls = 0;
};

struct Explanation {
  std::string caster;  ///< what casts rays
  std::vector<SensorTypeCost> kinds;
  std::vector<std::string> absent;                     ///< kinds that are not built
  std::vector<WallSlice> slices;                       ///< of lasers, by height
  std::size_t walls = 0;                               ///< of the world
  std::vector<sensors::AccuracyStatement> statements;  ///< modes and bounds, kind by kind
  std::uint64_t ticks = 0;                             ///< measured, for each row
  double build = 0.0;                                  ///< [s] tables and kernels
  double first = 0.0;                                  ///< [s] the first tick with all heard
  double silent = 0.0;                                 ///< [s] a tick with nobody heard, mean
  double all = 0.0;                                    ///< [s] a tick with all heard, mean
  std::size_t resident = 0;                            ///< [bytes] of this process, driver included; 0: not known
};

/// Drives the robots about for two seconds (`wander`), then ticks a farm along their ways: once with nobody heard, once
/// for each kind alone, once with all. @throws base::InputError as farm::Farm does
/// @param progress called now and then with the part in (0, 1] that is done; may be empty
Explanation explain(const world::World& world, gpu::Device& device, std::uint64_t seed, unsigned threads,
                    const std::function<void(double)>& progress = {});

}  // namespace sf::scenarios
