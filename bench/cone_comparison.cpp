#include "bench/cone_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/hash.h"
#include "bench/cone_methods.h"
#include "bench/report.h"
#include "bench/scans.h"
#include "sensors/sonar.h"
#include "tests/sensors/cone_trial.h"
#include "tests/sensors/edit_laser.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

constexpr std::size_t kRounds = 4;
constexpr std::size_t kJudgedRobots = 25;  // per round
constexpr std::size_t kPlain = 1;          // index of the method that ratios refer to

/// Returns the Pioneer's sonar ring from worlds/robots.inc without its firing order.
world::Sensor pioneers_ring() {
  const world::World pioneer =
      world::load_world(SF_SOURCE_DIR "/bench/pioneer.world", {.sensors = sensors::world_file_words()});
  world::Sensor ring = pioneer.movers.at(0).sensors.at(0);
  std::erase_if(ring.settings, [](const world::Setting& s) { return s.key == "firing"; });
  ring.settings.push_back({"firing", {}, "all", 0, ring.file});
  return ring;
}

Cost measure_once(ConeMethod& method, std::size_t round, const ConeComparison& comparison) {
  method.poison();
  const Cost start = now();
  method.measure(round);
  const Cost cost = since(start);
  for (std::size_t i = 0; i < comparison.cones; ++i)
    SF_CHECK(!std::isnan(method.range(i % comparison.robots, i / comparison.robots)),
             method.name() + " left cones unanswered");
  return cost;
}

std::uint64_t hash_of(const ConeMethod& method, std::size_t robots, std::size_t transducers) {
  std::vector<double> all;
  for (std::size_t r = 0; r < robots; ++r)
    for (std::size_t k = 0; k < transducers; ++k) all.push_back(method.range(r, k));
  return base::hash_bytes(all.data(), all.size() * sizeof all[0]);
}

/// Checks a sample of one round by testing every ray against every segment.
void check_accuracy(const ConeScene& scene, const std::vector<sensors::ConeArray>& arrays, const ConeMethod& method,
                    std::size_t round, ConeMethodResult& method_result) {
  const sensors::ConeArray& array = arrays[0];
  const double z = scene.world.movers[0].X_WM.z + array.row.X_MS.z;
  const auto all = oracle::surfaces(scene.world, scene.rounds[round], 0, z);
  for (std::size_t k = 0; k < kJudgedRobots; ++k) {
    const std::size_t robot = (k * arrays.size() / kJudgedRobots + 17 * round) % arrays.size();
    for (std::size_t i = 0; i < array.X_SC.size(); ++i) {
      const base::Pose X_MC = base::compose(array.row.X_MS, array.X_SC[i]);
      const trial::ConeTruth truth =
          trial::cone_truth(all, base::compose(scene.rounds[round][robot], X_MC), arrays[robot]);
      const double said = method.range(robot, i);
      method_result.worst = std::max({method_result.worst, truth.low - said, said - truth.high});
    }
  }
}

}  // namespace

ConeScene make_cone_scene(std::uint32_t robots) {
  ConeScene scene;
  scene.world = load_cave();
  scenes::add_robots(scene.world, robots, scenes::laser(), 1);
  const world::Sensor ring = pioneers_ring();
  for (world::Mover& mover : scene.world.movers) {
    mover.body.clear();
    scenes::remove_lasers(mover);
    mover.sensors.push_back(ring);
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    const auto k = static_cast<double>(round);
    std::vector<base::Pose>& poses = scene.rounds.emplace_back();
    for (const world::Mover& mover : scene.world.movers)
      poses.push_back(base::compose(mover.X_WM, {0.002 * k, 0.001 * k, 0.0, 0.1 * k}));
  }
  return scene;
}

ConeComparison compare_cones(gpu::Device& device, const ConeScene& scene, std::size_t repeats) {
  const auto arrays = sensors::cone_arrays_of(scene.world, "sonar", sensors::read_sonar);
  std::vector<std::unique_ptr<ConeMethod>> methods;
  methods.push_back(make_farm_cones(scene, device));
  methods.push_back(make_plain_cones(scene, arrays, "plain C++ grid, -O3", walk_portable));
  methods.push_back(make_plain_cones(scene, arrays, "plain C++ grid, -O3 -march=native", walk_native));
  const std::size_t cones = arrays.size() * arrays[0].X_SC.size();
  ConeComparison comparison{
      arrays.size(), cones, cones * arrays[0].rays, kRounds * kJudgedRobots * arrays[0].X_SC.size(), {}};
  for (const auto& method : methods) {
    comparison.method_results.emplace_back().method = method->name();
    for (std::size_t round = kRounds; round-- > 0;) {
      measure_once(*method, round, comparison);
      check_accuracy(scene, arrays, *method, round, comparison.method_results.back());
    }
    comparison.method_results.back().hash = hash_of(*method, arrays.size(), arrays[0].X_SC.size());
  }
  take_turns(comparison.method_results, repeats, methods[kPlain]->name(),
             [&](std::size_t k, std::size_t turn) { return measure_once(*methods[k], turn % kRounds, comparison); });
  return comparison;
}

void write_cones(const std::vector<ConeComparison>& comparisons, const std::string& folder) {
  if (comparisons.empty()) return;
  std::string text =
      "method,robots,cones,rays,turns,wall_ms_median,cpu_ms_median,mrays_per_s,ratio_to_plain,cpu_ratio_to_plain,"
      "max_error_m,judged,hash\n";
  for (const ConeComparison& o : comparisons)
    for (const ConeMethodResult& e : o.method_results)
      text += fmt::format("\"{}\",{},{},{},{},{:.3f},{:.3f},{:.2f},{:.3f},{:.3f},{:.3g},{},{}\n", e.method, o.robots,
                          o.cones, o.rays, e.repeats.size(), 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s,
                          1e-6 * static_cast<double>(o.rays) / e.typical.wall_s, e.ratio, e.cpu_ratio, e.worst,
                          o.checked, base::hash_hex(e.hash));
  write(folder + "/cones.csv", text);
}

std::string cone_table(const std::vector<ConeComparison>& comparisons) {
  std::string text;
  for (const ConeComparison& o : comparisons) {
    text += fmt::format("\nsonar rings: {} robots, {} cones, {} rays\n", o.robots, o.cones, o.rays);
    text += heading("Mrays/s") + "  max err m\n";
    for (const ConeMethodResult& e : o.method_results)
      text += row(e, static_cast<double>(o.rays)) + fmt::format(" {:>10.1e}\n", e.worst);
  }
  return text;
}

}  // namespace sf::bench
