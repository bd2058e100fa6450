#include "bench/field_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "bench/field_methods.h"
#include "sensors/magnetometer.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::bench {

namespace {

constexpr std::size_t kJudgedRobots = 7;  // per turn
constexpr const char* kReference = "plain C++, -O3";

/// Result of one method.
struct FieldMethodResult : Timing {
  double max_error = 0.0;   ///< relative to the largest field, over a sample of all turns
  std::size_t checked = 0;  ///< number of elements
};

/// Creates arrays as in the thesis on robots at random positions in the extent, 8.5 cm above the ground.
FieldScene fleet_on(std::string name, world::World world, std::uint32_t arrays, std::size_t repeats) {
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  for (const world::Magnet& m : world.magnets) {
    x0 = std::min(x0, m.p.x), x1 = std::max(x1, m.p.x);
    y0 = std::min(y0, m.p.y), y1 = std::max(y1, m.p.y);
  }
  world.movers.clear();
  FieldScene scene{std::move(name), std::move(world), repeats, {}};
  for (std::uint32_t i = 0; i < arrays; ++i) scenes::add_carrier(scene.world, {}, scenes::five(0.085));
  trial::Chance chance(5);
  for (std::size_t repeat = 0; repeat <= repeats; ++repeat) {
    std::vector<base::Pose>& poses = scene.rounds.emplace_back();
    for (std::uint32_t i = 0; i < arrays; ++i) {
      const double x = chance.between(x0, x1), y = chance.between(y0, y1);
      poses.push_back({x, y, 0.0, chance.between(-M_PI, M_PI)});
    }
  }
  return scene;
}

/// Compares a sample of one turn with direct sums.
void check_accuracy(const FieldScene& scene, const FieldMethod& method, std::size_t repeat,
                    FieldMethodResult& method_result, double& largest) {
  const std::size_t robots = scene.world.movers.size();
  const sensors::Magnetometer m = sensors::read_magnetometer(scene.world.movers[0].sensors[0]);
  for (std::size_t k = 0; k < kJudgedRobots; ++k) {
    const std::size_t robot = (k * robots / kJudgedRobots + 131 * repeat) % robots;
    for (std::size_t e = 0; e < kArrayElements; ++e) {
      const base::Pose X_MS = scene.world.movers[robot].sensors[0].X_MS;
      const base::Pose X_WE = base::compose(scene.rounds[repeat][robot], base::compose(X_MS, m.X_SE[e]));
      const scenes::Exact truth = scenes::exact(scene.world, {X_WE.x, X_WE.y, X_WE.z}, scene.world.magnet_cutoff);
      const FieldVector b = method.value(robot, e);
      const glm::dvec2 flat = base::rotate(X_WE.yaw, {b.x, b.y});
      const double error = scenes::apart(truth, {flat.x, flat.y, b.z, 0.0});
      SF_CHECK(std::isfinite(error), method.name() + " left an element unanswered");
      method_result.max_error = std::max(method_result.max_error, error);
      largest = std::max(largest, scenes::magnitude(truth));
      ++method_result.checked;
    }
  }
}

}  // namespace

FieldScene simville_scene(std::uint32_t arrays, std::size_t repeats) {
  return fleet_on("SimVille", world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world"), arrays, repeats);
}

FieldScene sheet_scene(std::uint32_t arrays, std::uint32_t magnets, double cutoff, std::size_t repeats) {
  world::World world = scenes::sheet(magnets, std::sqrt(magnets), 3);
  world.magnet_cutoff = cutoff;
  return fleet_on("one a square metre", std::move(world), arrays, repeats);
}

Report compare_fields(const FieldScene& scene, gpu::Device& device) {
  gpu::Device host{std::string(gpu::kHostDevice)};  // must outlive its farm
  std::vector<std::unique_ptr<FieldMethod>> methods;
  methods.push_back(make_farm_method(scene, device));
  methods.push_back(make_plain_method(scene, kReference, sum_portable));
  methods.push_back(make_plain_method(scene, "plain C++, -O3 -march=native", sum_native));
  methods.push_back(make_farm_method(scene, host));
  std::vector<FieldMethodResult> results;
  for (const auto& method : methods) {
    method->sum(scene.repeats);  // warm-up
    results.emplace_back().method = method->name();
  }
  const double before = methods[0]->pairs();
  double largest = 0.0;
  take_turns(results, scene.repeats, kReference, [&](std::size_t k, std::size_t turn) {
    methods[k]->poison();
    const Cost start = now();
    methods[k]->sum(turn);
    const Cost cost = since(start);
    check_accuracy(scene, *methods[k], turn, results[k], largest);
    return cost;
  });
  for (FieldMethodResult& method_result : results) method_result.max_error /= largest;

  const world::World& world = scene.world;
  const std::size_t arrays = world.movers.size(), magnets = world.magnets.size();
  const double pairs = (methods[0]->pairs() - before) / static_cast<double>(scene.repeats);
  Report report{"field", "",
                "scene,method,arrays,elements,magnets,cutoff_m,pairs,turns,wall_ms_median,cpu_ms_median,gpairs_per_s,"
                "ratio_to_plain,cpu_ratio_to_plain,max_error_of_largest,judged"};
  report.text =
      fmt::format("\nmagnets, {}: {} arrays of {} over {} magnets, cut-off {:g} m, {:.3g} pairs\n{}    max err\n",
                  scene.name, arrays, kArrayElements, magnets, world.magnet_cutoff, pairs, heading("Mpairs/s"));
  const auto csv = [&](const FieldMethodResult& e) {
    return fmt::format("\"{}\",\"{}\",{},{},{},{:g},{:.0f},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3g},{}\n",
                       scene.name, e.method, arrays, arrays * kArrayElements, magnets, world.magnet_cutoff, pairs,
                       e.repeats.size(), 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s, 1e-9 * pairs / e.typical.wall_s,
                       e.ratio, e.cpu_ratio, e.max_error, e.checked);
  };
  add_methods(report, results, csv,
              [&](const FieldMethodResult& e) { return row(e, pairs) + fmt::format(" {:>10.1e}\n", e.max_error); });
  return report;
}

}  // namespace sf::bench
