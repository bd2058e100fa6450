#include "bench/measurements.h"

#include <cstdlib>
#include <filesystem>

#include "base/error.h"
#include "bench/comparison.h"
#include "bench/cost.h"
#include "bench/farm_caster.h"
#include "farm/farm.h"
#include "scenarios/runner.h"
#include "scenarios/simulation.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

constexpr int kRepeats = 21;

/// Measures all due sensors even if the robots do not move.
const farm::FarmOptions kAnew{.reuse_unchanged = false};

/// Median cost of a tick in which every sensor is due.
Cost tick_cost(farm::Farm& farm) {
  std::vector<Cost> costs;
  std::int64_t time = 0;
  for (int k = 0; k < kRepeats + 2; ++k, time += 100'000'000) {
    const Cost start = now();
    farm.tick(time, {});
    if (k >= 2) costs.push_back(since(start));
  }
  return median(costs);
}

double first_tick(const world::World& world, gpu::Device& device) {
  farm::Farm farm(world, device);
  farm.subscribe_all();
  const double start = now().wall_s;
  farm.tick(0, {});
  return now().wall_s - start;
}

}  // namespace

std::vector<Measurement> measure_start() {
  world::World world = load_cave();
  scenes::add_robots(world, 1, scenes::laser(), 1);
  std::vector<Measurement> facts;
  setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  {
    const double start = now().wall_s;
    gpu::Device device;
    facts.push_back({"opening the device, self-check included, nothing cached", 1e3 * (now().wall_s - start), "ms"});
    facts.push_back({"first tick of one robot, kernel compiled", 1e3 * first_tick(world, device), "ms"});
  }
  unsetenv("MESA_SHADER_CACHE_DISABLE");
  {
    gpu::Device device;
    first_tick(world, device);
  }
  const double start = now().wall_s;
  gpu::Device device;
  facts.push_back({"opening the device, kernels from the driver's cache", 1e3 * (now().wall_s - start), "ms"});
  facts.push_back({"first tick of one robot, kernel from the driver's cache", 1e3 * first_tick(world, device), "ms"});
  return facts;
}

std::vector<Measurement> measure_ticks(gpu::Device& device) {
  std::vector<Measurement> facts;
  const world::World thousand = make_scans("cave", load_cave(), 1000, scenes::laser()).world;
  farm::Farm unsubscribed(thousand, device);
  facts.push_back({"tick of 1000 robots, none subscribed", 1e6 * tick_cost(unsubscribed).wall_s, "us"});

  const world::World one = make_scans("cave", load_cave(), 1, scenes::laser(1)).world;
  farm::Farm single(one, device, kAnew);
  single.subscribe_all();
  facts.push_back({"tick of 1 robot with 1 beam", 1e6 * tick_cost(single).wall_s, "us"});

  const Scans many = make_scans("cave", load_cave(), 1, scenes::laser(100'000));
  std::vector<std::unique_ptr<Caster>> casters;
  casters.push_back(make_farm_caster(many, device));
  const MethodResult farm = compare(many, casters, "", kRepeats).method_results[0];
  SF_CHECK(farm.accuracy.max_error_m < 1e-6, "100 000 beams of one sensor are wrong");
  facts.push_back({"scan of 1 robot with 100 000 beams, 8 m", 1e3 * farm.typical.wall_s, "ms"});
  facts.push_back({"rays of 1 robot with 100 000 beams, 8 m", mrays_per_s(many.rays(), farm.typical), "M/s"});
  return facts;
}

std::vector<Measurement> measure_lists(gpu::Device& device) {
  std::vector<Measurement> facts;
  for (const double range : {8.0, 0.75}) {
    const Scans scans = make_scans("cave", load_cave(), 1000, scenes::laser(361, M_PI, range));
    farm::Farm farm(scans.world, device, kAnew);
    farm.subscribe_all();
    const Cost start = now();
    farm.tick(0, {});
    const Cost first = since(start);
    const Cost later = tick_cost(farm);
    const auto cells = static_cast<double>(farm.stats().work.cells_built);
    const std::string at = " at " + std::string(range > 1.0 ? "8" : "0.75") + " m";
    facts.push_back({"cells that 1000 robots need" + at, cells, "cells"});
    facts.push_back({"lists of a new cell" + at + ", one core", 1e6 * (first.cpu_s - later.cpu_s) / cells, "us"});
    facts.push_back({"first tick of 1000 robots" + at, 1e3 * first.wall_s, "ms"});
  }
  return facts;
}

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
