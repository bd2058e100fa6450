#include "bench/field_contest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "bench/field_methods.h"
#include "bench/report.h"
#include "sensors/magnetometer.h"
#include "tests/sensors/magnet_scenes.h"

namespace sf::bench {

namespace {

constexpr std::size_t kJudgedRobots = 7;  // of each turn
constexpr const char* kReference = "plain C++, -O3";

/// Arrays of the thesis on robots anywhere in the extent, 8.5 cm up.
FieldScene fleet_on(std::string name, world::World world, std::uint32_t arrays, std::size_t turns) {
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  for (const world::Magnet& m : world.magnets) {
    x0 = std::min(x0, m.p.x), x1 = std::max(x1, m.p.x);
    y0 = std::min(y0, m.p.y), y1 = std::max(y1, m.p.y);
  }
  world.movers.clear();
  FieldScene scene{std::move(name), std::move(world), turns, {}};
  for (std::uint32_t i = 0; i < arrays; ++i) scenes::add_carrier(scene.world, {}, scenes::five(0.085));
  trial::Chance chance(5);
  for (std::size_t turn = 0; turn <= turns; ++turn) {
    std::vector<base::Pose>& poses = scene.rounds.emplace_back();
    for (std::uint32_t i = 0; i < arrays; ++i) {
      const double x = chance.between(x0, x1), y = chance.between(y0, y1);
      poses.push_back({x, y, 0.0, chance.between(-M_PI, M_PI)});
    }
  }
  return scene;
}

/// Compares a sample of a turn with direct sums.
void judge(const FieldScene& scene, const FieldMethod& method, std::size_t turn, FieldEntrant& entrant,
           double& largest) {
  const std::size_t robots = scene.world.movers.size();
  const sensors::Magnetometer m = sensors::read_magnetometer(scene.world.movers[0].sensors[0]);
  for (std::size_t k = 0; k < kJudgedRobots; ++k) {
    const std::size_t robot = (k * robots / kJudgedRobots + 131 * turn) % robots;
    for (std::size_t e = 0; e < kArrayElements; ++e) {
      const base::Pose X_MS = scene.world.movers[robot].sensors[0].X_MS;
      const base::Pose X_WE = base::compose(scene.rounds[turn][robot], base::compose(X_MS, m.X_SE[e]));
      const scenes::Exact truth = scenes::exact(scene.world, {X_WE.x, X_WE.y, X_WE.z}, scene.world.magnet_cutoff);
      const FieldVector b = method.value(robot, e);
      const glm::dvec2 flat = base::rotate(X_WE.yaw, {b.x, b.y});
      const double error = scenes::apart(truth, {flat.x, flat.y, b.z, 0.0});
      SF_CHECK(std::isfinite(error), method.name() + " left an element unanswered");
      entrant.max_error = std::max(entrant.max_error, error);
      largest = std::max(largest, scenes::magnitude(truth));
      ++entrant.judged;
    }
  }
}

void rate(std::vector<FieldEntrant>& entrants) {
  const auto reference =
      std::find_if(entrants.begin(), entrants.end(), [](const FieldEntrant& e) { return e.method == kReference; });
  for (FieldEntrant& entrant : entrants) {
    entrant.typical = median(entrant.turns);
    const Cost times = ratio(reference->turns, entrant.turns);
    entrant.ratio = times.wall_s;
    entrant.cpu_ratio = times.cpu_s;
  }
}

}  // namespace

FieldScene simville_scene(std::uint32_t arrays, std::size_t turns) {
  return fleet_on("SimVille", world::load_world(SF_SOURCE_DIR "/worlds/simville/simville.world"), arrays, turns);
}

FieldScene sheet_scene(std::uint32_t arrays, std::uint32_t magnets, double cutoff, std::size_t turns) {
  world::World world = scenes::sheet(magnets, std::sqrt(magnets), 3);
  world.magnet_cutoff = cutoff;
  return fleet_on("one a square metre", std::move(world), arrays, turns);
}

FieldOutcome compete(const FieldScene& scene, gpu::Device& device) {
  std::vector<std::unique_ptr<FieldMethod>> methods;
  methods.push_back(make_farm_method(scene, device));
  methods.push_back(make_plain_method(scene, kReference, sum_portable));
  methods.push_back(make_plain_method(scene, "plain C++, -O3 -march=native", sum_native));
  FieldOutcome outcome{
      scene.name, scene.world.movers.size(), scene.world.magnets.size(), scene.world.magnet_cutoff, 0.0, {}};
  for (const auto& method : methods) {
    method->sum(scene.turns);  // warm up
    outcome.entrants.push_back({method->name(), {}, {}, 0.0, 0.0, 0});
  }
  const double before = methods[0]->pairs();
  double largest = 0.0;
  for (std::size_t turn = 0; turn < scene.turns; ++turn)
    for (std::size_t k = 0; k < methods.size(); ++k) {
      const std::size_t who = (turn + k) % methods.size();
      methods[who]->poison();
      const Cost start = now();
      methods[who]->sum(turn);
      outcome.entrants[who].turns.push_back(now() - start);
      judge(scene, *methods[who], turn, outcome.entrants[who], largest);
    }
  outcome.pairs = (methods[0]->pairs() - before) / static_cast<double>(scene.turns);
  for (FieldEntrant& entrant : outcome.entrants) entrant.max_error /= largest;
  rate(outcome.entrants);
  return outcome;
}

void write_csv(const std::vector<FieldOutcome>& outcomes, const std::string& folder) {
  if (outcomes.empty()) return;
  std::string text =
      "scene,method,arrays,elements,magnets,cutoff_m,pairs,turns,wall_ms_median,cpu_ms_median,gpairs_per_s,"
      "ratio_to_plain,cpu_ratio_to_plain,max_error_of_largest,judged\n";
  for (const FieldOutcome& o : outcomes)
    for (const FieldEntrant& e : o.entrants)
      text += fmt::format("\"{}\",\"{}\",{},{},{},{:g},{:.0f},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3g},{}\n",
                          o.scene, e.method, o.arrays, o.arrays * kArrayElements, o.magnets, o.cutoff_m, o.pairs,
                          e.turns.size(), 1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s,
                          1e-9 * o.pairs / e.typical.wall_s, e.ratio, e.cpu_ratio, e.max_error, e.judged);
  write(folder + "/field.csv", text);
}

std::string table(const std::vector<FieldOutcome>& outcomes) {
  std::string text;
  for (const FieldOutcome& o : outcomes) {
    text += fmt::format("\nmagnets, {}: {} arrays of {} over {} magnets, cut-off {:g} m, {:.3g} pairs\n", o.scene,
                        o.arrays, kArrayElements, o.magnets, o.cutoff_m, o.pairs);
    text += fmt::format("{:<32} {:>9} {:>9} {:>9} {:>7} {:>7} {:>10}\n", "method", "wall ms", "cpu ms", "Gpairs/s",
                        "ratio", "cpu", "max err");
    for (const FieldEntrant& e : o.entrants)
      text += fmt::format("{:<32} {:>9.2f} {:>9.2f} {:>9.3f} {:>7.2f} {:>7.2f} {:>10.1e}\n", e.method,
                          1e3 * e.typical.wall_s, 1e3 * e.typical.cpu_s, 1e-9 * o.pairs / e.typical.wall_s, e.ratio,
                          e.cpu_ratio, e.max_error);
  }
  return text;
}

}  // namespace sf::bench
