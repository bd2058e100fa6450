#pragma once
// The tables and kernels of worlds on a device.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "library/loading.h"
#include "library/observations.h"
#include "raycast/pose_scanner.h"
#include "robots/device/device_fleet.h"
#include "robots/device/device_observer.h"
#include "sensorfarm/device_worlds.h"
#include "sensors/sensor_set.h"

namespace sensorfarm {

/// Not thread-safe. Throws sf::base::InputError and sf::base::DeviceError.
struct DeviceWorlds::State : std::enable_shared_from_this<State> {
  State(const sf::library::WorldSource& source, const Options& options);
  void step(std::span<const Twist> given);
  void reset(std::span<const std::uint32_t> worlds, std::span<const std::uint64_t> seeds, const WorldStarts& starts);
  void restart(std::uint32_t copy);
  void scan_starts();
  void read_states();
  void read_ranges();
  void record();
  void changed();
  void observe(const ObservationOptions& options);
  void set_goals(std::span<const double> goals);
  void read_observations();
  DeviceArray array(DeviceTable table);
  void update();
  void flush();

  std::shared_ptr<sf::gpu::Device> device;
  sf::library::LoadedWorld loaded;
  sf::world::World& world = loaded.world;
  std::optional<sf::sensors::SensorSet> sensor_set;
  std::optional<sf::raycast::Episodes> episodes;
  std::optional<sf::robots::DeviceFleet> fleet;
  std::optional<sf::raycast::PoseScanner> scanner;
  std::shared_ptr<sf::robots::DeviceObserver> observer;  ///< null: nothing is observed
  std::optional<Observations::State> observed;           ///< its agents
  std::int64_t interval = 0;                             ///< [ns]
  std::vector<Robot> robots;
  std::vector<Pose> poses;
  std::vector<Twist> velocities;
  std::vector<std::uint32_t> carriers;  ///< per laser
  Readings readings;
  bool commands_there = false;  ///< consumers write commands to the device's memory, by CUDA
  bool starting = true;         ///< worlds have restarted since the last scan
  bool states_read = false, ranges_read = false, observations_read = false;
};

}  // namespace sensorfarm
