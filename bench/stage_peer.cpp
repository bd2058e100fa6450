#include "bench/stage_peer.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/error.h"
#include "bench/cost.h"
#include "scenarios/simulation.h"

namespace sf::bench {

namespace {

constexpr double kLoadOnly = 0.1;  // [s] simulated
constexpr int kRounds = 3;

/// Size of a fleet and its cave. The cave's usual size has no room for a thousand robots.
struct Crowd {
  std::uint32_t robots;
  double side;  ///< [m] of the cave
};
constexpr Crowd kCrowds[] = {{100, 16.0}, {300, 16.0}, {1'000, 48.0}};

/// Loads worlds/cave.world with the floor plan scaled to another size.
world::World load_cave(const Crowd& crowd, const std::string& file) {
  std::ifstream in(SF_SOURCE_DIR "/worlds/cave.world");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto replace = [&text](const std::string& old, const std::string& by) {
    const std::size_t at = text.find(old);
    SF_CHECK(at != std::string::npos, "cave.world has no " + old);
    text.replace(at, old.size(), by);
  };
  replace("[16 16 0.8]", fmt::format("[{0} {0} 0.8]", crowd.side));
  replace("\"bitmaps/cave.png\"", "\"" SF_SOURCE_DIR "/worlds/bitmaps/cave.png\"");
  std::ofstream(file) << text;
  world::World world = world::load_world(file, {.sensors = sensors::world_file_words()});
  world::clone_robots(world, crowd.robots, 1);
  return world;
}

/// Writes the same robots as a Stage world, driven by Stage's wander controller.
void write_stage_world(const world::World& world, const Crowd& crowd, double seconds, const std::string& file) {
  std::ofstream out(file);
  out << "interval_sim 100\nspeedup -1\nresolution 0.02\nquit_time " << seconds << "\n"
      << "define create position ( size [0.33 0.33 0.1] drive \"diff\" block ( points 16";
  for (int i = 0; i < 16; ++i)
    out << fmt::format(" point[{}] [{:.5f} {:.5f}]", i, std::cos(i * M_PI / 8), std::sin(i * M_PI / 8));
  out << " z [0 0.1] ) ranger ( size [0.06 0.06 0.05] pose [0.1 0 -0.075 0] sensor ( range [0 8] fov 180 samples 361 ) "
         ") ctrl \"wander\" )\n"
      << "model ( name \"walls\" size [" << crowd.side << " " << crowd.side
      << " 0.8] boundary 0 gui_nose 0 gui_move 0 obstacle_return 1 ranger_return 0.5 "
         "bitmap \""
      << SF_SOURCE_DIR << "/worlds/bitmaps/cave.png\" )\n";
  for (std::size_t m = 0; m < world.movers.size(); ++m) {
    const base::Pose& X = world.movers[m].X_WM;
    out << fmt::format("create ( name \"r{}\" pose [{:.4f} {:.4f} 0 {:.3f}] )\n", m, X.x, X.y, X.yaw * 180.0 / M_PI);
  }
}

/// [s] Wall time.
double run_stage(const std::string& program, const std::string& file) {
  const double start = now().wall_s;
  const std::string command = fmt::format("'{}' -g '{}' >/dev/null 2>&1", program, file);
  SF_CHECK(std::system(command.c_str()) == 0, "Stage did not run: " + command);
  return now().wall_s - start;
}

double run_farm(const world::World& world, gpu::Device& device, double seconds) {
  scenarios::Simulation simulation(world, device, {});
  simulation.step();
  const double start = now().wall_s;
  for (double t = world.interval; t < seconds; t += world.interval) simulation.step();
  return now().wall_s - start;
}

}  // namespace

std::vector<Measurement> measure_beside_stage(gpu::Device& device) {
  const char* const program = std::getenv("STAGE");
  std::vector<Measurement> facts;
  if (program == nullptr) return facts;
  const std::string file = std::filesystem::temp_directory_path() / fmt::format("beside_stage_{}.world", ::getpid());
  for (const Crowd& crowd : kCrowds) {
    const double seconds = 3'000.0 / crowd.robots;
    const world::World world = load_cave(crowd, file);
    std::vector<double> stage, farm;
    for (int round = 0; round < kRounds; ++round) {
      write_stage_world(world, crowd, kLoadOnly, file);
      const double load = run_stage(program, file);
      write_stage_world(world, crowd, seconds + kLoadOnly, file);
      stage.push_back(run_stage(program, file) - load);
      farm.push_back(run_farm(world, device, seconds));
    }
    std::sort(stage.begin(), stage.end());
    std::sort(farm.begin(), farm.end());
    const double theirs = stage[kRounds / 2], ours = farm[kRounds / 2];
    const std::string scene = fmt::format("{} wandering in a cave of {} m", crowd.robots, crowd.side);
    facts.push_back({"Stage, " + scene, seconds / theirs, "x real time"});
    facts.push_back({"farm, " + scene, seconds / ours, "x real time"});
    facts.push_back({"farm over Stage, " + scene, theirs / ours, "x"});
  }
  std::filesystem::remove(file);
  return facts;
}

}  // namespace sf::bench
