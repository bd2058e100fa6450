#include "bench/fleet_runs.h"

#include <filesystem>

#include "base/error.h"
#include "bench/cost.h"
#include "scenarios/runner.h"
#include "scenarios/simulation.h"

namespace sf::bench {

namespace {

constexpr std::uint32_t kHospitalRobots = 1'000;
constexpr int kHospitalTicks = 200;

Measurement simville(gpu::Device& device) {
  const auto scenario = scenarios::read_scenario(std::string(SF_SOURCE_DIR) + "/experiments/simville.toml");
  const auto result = scenarios::run_scenario(scenario, device);
  SF_CHECK(result.status() == scenarios::ScenarioStatus::passed, "SimVille's traffic did not do what it should");
  return {"SimVille's traffic, 52 robots", result.simulated / result.wall, "x real time"};
}

/// @return real-time factor, and the hash of all readings
std::pair<double, std::uint64_t> wander_in(const world::World& world, gpu::Device& device) {
  scenarios::Simulation simulation(world, device, {});
  const double start = now().wall_s;
  for (int k = 0; k < kHospitalTicks; ++k) simulation.step();
  return {kHospitalTicks * world.interval / (now().wall_s - start), simulation.farm().hash()};
}

}  // namespace

std::vector<Measurement> measure_fleets(gpu::Device& device) {
  std::vector<Measurement> facts{simville(device)};
  const std::string hospital = std::string(SF_SOURCE_DIR) + "/../shared/data/stage/benchmark/hospital.world";
  if (!std::filesystem::exists(hospital)) return facts;
  world::World world = world::load_world(hospital, {.sensors = sensors::world_file_words()});
  world::clone_robots(world, kHospitalRobots, 1);
  const auto [first, hash] = wander_in(world, device);
  const auto [second, same] = wander_in(world, device);
  SF_CHECK(hash == same, "two runs in the hospital differ");
  facts.push_back({"Stage's hospital, 1000 wandering", std::max(first, second), "x real time"});
  return facts;
}

}  // namespace sf::bench
