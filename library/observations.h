#pragma once
// Computes the observations of one simulation.

#include <cstdint>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "sensorfarm/simulation.h"
#include "sensors/sensor_set.h"
#include "world/world.h"

namespace sf::library {

/// The data of one step from which observations are computed.
struct ObservedStep {
  sensorfarm::Readings readings;  ///< of the observed type
  std::span<const sensorfarm::Pose> poses;
  std::span<const sensorfarm::Twist> velocities;
};

}  // namespace sf::library

namespace sensorfarm {

/// Not thread-safe.
struct Observations::State {
  /// @param group of the observed type  @throws sf::base::InputError as Simulation::observe
  State(const ObservationOptions& options, const sf::world::World& world, const sf::sensors::SensorSet::Group& group);

  /// Takes a step of all agents, or the first tick of the agents of some worlds.
  void step(const sf::library::ObservedStep& now, sf::base::ThreadPool& thread_pool);
  void restart(const sf::library::ObservedStep& now, std::span<const std::uint32_t> worlds);
  /// Writes the newest observations again.
  void update();

  std::size_t columns() const { return newest * options.stack; }  ///< of a row

  ObservationOptions options;
  struct Agent {
    std::uint32_t sensor;   ///< its first row of readings
    double forward, turn;   ///< largest speeds
    double goal_x, goal_y;  ///< of `distances`
  };
  std::vector<Agent> agents;
  std::vector<double> limits;  ///< per row of readings
  std::size_t newest = 0;      ///< columns of one observation
  std::vector<std::uint32_t> rows;
  std::vector<float> values;
  std::vector<double> goals, distances, progress;
  std::vector<std::uint32_t> ages;

 private:
  void write(std::size_t agent);
  void measure(std::size_t agent, bool moved);
  void shift(std::size_t agent);
  void fill(std::size_t agent);

  std::uint32_t worlds_;
  std::size_t sensors_ = 0;   ///< per agent
  std::size_t elements_ = 0;  ///< of a reading, as observed
  sf::library::ObservedStep now_;
};

}  // namespace sensorfarm
