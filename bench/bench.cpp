// Runs all measurements as Google benchmarks: `sensorfarm_bench [--results=FOLDER] [--pictures=FOLDER]
// [--benchmark_filter=...]`.
//
// A comparison runs completely when the first of its methods is benchmarked, since methods have to take turns. The
// benchmarks then report each method's turns one by one.

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <cstring>
#include <functional>
#include <map>

#include "base/error.h"
#include "base/hash.h"
#include "bench/accuracy_modes.h"
#include "bench/cone_comparison.h"
#include "bench/curves.h"
#include "bench/embree_caster.h"
#include "bench/farm_caster.h"
#include "bench/field_comparison.h"
#include "bench/grid.h"
#include "bench/lane_comparison.h"
#include "bench/large_fleet.h"
#include "bench/map_comparison.h"
#include "bench/price.h"
#include "bench/report.h"
#include "bench/stage_peer.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

struct Session {
  gpu::Device device;
  std::vector<Report> reports;
  std::map<std::string, Comparison> comparisons;  ///< measured once and reported several times
  std::vector<Curve> curves;                      ///< for the picture
};

struct ScanCase {
  std::uint32_t robots;
  double range;
  std::size_t repeats;
};
constexpr ScanCase kScanCases[] = {{1'000, 8.0, 41}, {1'000, 0.75, 41}, {10'000, 8.0, 15}, {10'000, 0.75, 15}};
constexpr std::size_t kMethods = 8;

const Comparison& scan_comparison(Session& session, const ScanCase& c) {
  const std::string name = fmt::format("{}/{}", c.robots, c.range);
  const auto known = session.comparisons.find(name);
  if (known != session.comparisons.end()) return known->second;
  const Scans scans = make_scans("cave", load_cave(), c.robots, scenes::laser(361, M_PI, c.range));
  std::vector<std::unique_ptr<Caster>> casters;
  casters.push_back(make_farm_caster(scans, session.device));
  casters.push_back(make_grid_caster(scans, "plain C++ grid", walk_portable));
  casters.push_back(make_grid_caster(scans, "plain C++ grid, -march=native", walk_native));
  for (const EmbreeUse use :
       {EmbreeUse{8, false}, EmbreeUse{8, true}, EmbreeUse{16, false}, EmbreeUse{16, true}, EmbreeUse{1, false}})
    if (auto caster = make_embree_caster(scans, use)) casters.push_back(std::move(caster));
  const Comparison comparison = compare(scans, casters, "embree", c.repeats);
  session.reports.push_back(scan_report(comparison));
  return session.comparisons[name] = comparison;
}

void report(benchmark::State& state, const std::vector<Cost>& costs, std::size_t rays, const AccuracyCheck& accuracy,
            std::uint64_t hash) {
  std::size_t k = 0;
  double cpu_s = 0.0;
  for (auto _ : state) {
    state.SetIterationTime(costs[k % costs.size()].wall_s);
    cpu_s += costs[k++ % costs.size()].cpu_s;
  }
  state.counters["Mrays/s"] = benchmark::Counter(1e-6 * static_cast<double>(rays * k), benchmark::Counter::kIsRate,
                                                 benchmark::Counter::kIs1000);
  state.counters["cpu_ms"] = 1e3 * cpu_s / static_cast<double>(k);
  state.SetLabel(fmt::format("max error {:.1e} m of {} beams, hash {}", accuracy.max_error_m, accuracy.beams,
                             base::hash_hex(hash)));
}

void report_scan(benchmark::State& state, Session& session, const ScanCase& c, std::size_t which) {
  const Comparison& comparison = scan_comparison(session, c);
  if (which >= comparison.method_results.size()) return state.SkipWithError("built without Embree");
  const MethodResult& e = comparison.method_results[which];
  report(state, e.repeats, comparison.rays, e.accuracy, e.hash);
  state.counters["ratio"] = e.ratio;
}

struct TickCase {
  std::uint32_t robots;
  double range;
  bool wander;
  std::size_t ticks;
};
constexpr TickCase kTickCases[] = {{100, 8.0, false, 101},  {100, 8.0, true, 201},  {100, 0.75, true, 201},
                                   {1'000, 8.0, false, 41}, {1'000, 8.0, true, 61}, {1'000, 0.75, true, 61}};
constexpr std::size_t kWarmUp = 20;

void report_ticks(benchmark::State& state, Session& session, const TickCase& c) {
  // A thousand bodies need more space: a cave with three times the side length and proportionally many caverns.
  const bool large = c.robots > 100;
  world::World world = large ? scenes::cave(1500, 48.0, 3) : load_cave();
  scenes::add_robots(world, c.robots, scenes::laser(361, M_PI, c.range), 1);
  const TickResult result = run_ticks(large ? "large cave" : "cave", world, session.device, c.wander, kWarmUp, c.ticks);
  session.reports.push_back(tick_report(result));
  report(state, result.ticks, result.rays, result.accuracy, result.hash);
  state.counters["x_real_time"] = result.interval_s / result.typical.wall_s;
}

struct FieldCase {
  const char* name;
  FieldScene (*scene)();
};
constexpr FieldCase kFieldCases[] = {
    {"field/simville/10000", [] { return simville_scene(10'000, 31); }},
    {"field/200000_magnets/10000", [] { return sheet_scene(10'000, 200'000, 10.0, 31); }},
    {"field/200000_magnets/100/no_cutoff", [] { return sheet_scene(100, 200'000, 0.0, 11); }}};

struct LaneCase {
  const char* name;
  double resolution;  ///< [m] 0: exact markings
};
constexpr LaneCase kLaneCases[] = {
    {"laneedge/exact/10000", 0.0}, {"laneedge/raster_5mm/10000", 0.005}, {"laneedge/raster_20mm/10000", 0.02}};
constexpr std::size_t kLaneTurns = 15;

constexpr std::uint32_t kConeCases[] = {100, 1'000};
constexpr std::size_t kConeTurns = 31;

struct MapCase {
  const char* name;
  std::uint32_t robots;
  double range;  ///< [m]
  bool weighs;
};
constexpr MapCase kMapCases[] = {{"maps/1000/0.75m", 1'000, 0.75, false},
                                 {"maps/1000/0.75m/log_odds", 1'000, 0.75, true},
                                 {"maps/200/8m", 200, 8.0, false}};
constexpr std::size_t kMapTurns = 25;

constexpr std::uint32_t kLargeFleet = 10'000;
constexpr std::size_t kLargeFleetTicks = 60;

struct CurveCase {
  const char* name;
  Curve (*measure)(gpu::Device& device);
};
constexpr CurveCase kCurveCases[] = {
    {"curves/standing", [](gpu::Device& device) { return robots_curve(device, false, 100'000); }},
    {"curves/wandering", [](gpu::Device& device) { return robots_curve(device, true, 30'000); }},
    {"curves/city", [](gpu::Device& device) { return segments_curve(device, 10'000'000); }}};

constexpr double kModeRanges[] = {8.0, 0.75};
constexpr std::uint32_t kModeRobots = 1'000;
constexpr std::size_t kModeTurns = 21;

const char* method_key(std::size_t which) {
  constexpr const char* kKeys[kMethods] = {"farm",           "grid",     "grid_native",     "embree8",
                                           "embree8_robust", "embree16", "embree16_robust", "embree1"};
  return kKeys[which];
}

/// Registers a measurement that runs once.
void register_once(const std::string& name, Session& session, const std::function<Report()>& measure) {
  benchmark::RegisterBenchmark(name.c_str(),
                               [&session, measure](benchmark::State& state) {
                                 for (auto _ : state) session.reports.push_back(measure());
                                 for (const auto& [counter, value] : session.reports.back().counters)
                                   state.counters[counter] = value;
                               })
      ->Unit(benchmark::kMillisecond)
      ->Iterations(1);
}

/// @param repeats of the measurement, which are reported one by one
void register_repeats(const std::string& name, std::size_t repeats,
                      const std::function<void(benchmark::State&)>& measure) {
  benchmark::RegisterBenchmark(name.c_str(), measure)
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(static_cast<benchmark::IterationCount>(repeats));
}

void register_comparisons(Session& session) {
  for (const ScanCase& c : kScanCases)
    for (std::size_t which = 0; which < kMethods; ++which)
      register_repeats(fmt::format("scan/cave/{}/{}m/{}", c.robots, c.range, method_key(which)), c.repeats,
                       [&session, &c, which](benchmark::State& s) { report_scan(s, session, c, which); });
  for (const TickCase& c : kTickCases)
    register_repeats(fmt::format("tick/{}/{}m/{}", c.robots, c.range, c.wander ? "wandering" : "standing"), c.ticks,
                     [&session, &c](benchmark::State& s) { report_ticks(s, session, c); });
  gpu::Device& device = session.device;
  for (const FieldCase& c : kFieldCases)
    register_once(c.name, session, [&] { return compare_fields(c.scene(), device); });
  for (const LaneCase& c : kLaneCases)
    register_once(c.name, session,
                  [&] { return compare_lanes(device, make_lane_scene(20, 10'000, c.resolution), kLaneTurns); });
  for (const std::uint32_t robots : kConeCases)
    register_once(fmt::format("sonar/cave/{}", robots), session,
                  [&device, robots] { return compare_cones(device, make_cone_scene(robots), kConeTurns); });
  for (const double range : kModeRanges)
    register_once(fmt::format("accuracy_modes/cave/{}/{}m", kModeRobots, range), session,
                  [&device, range] { return compare_accuracy_modes(device, kModeRobots, range, kModeTurns); });
  register_once(fmt::format("large_fleet/{}", kLargeFleet), session,
                [&device] { return drive_large_fleet(device, kLargeFleet, kLargeFleetTicks); });
  for (const CurveCase& c : kCurveCases)
    register_once(c.name, session,
                  [&] { return curve_report(session.curves.emplace_back(c.measure(session.device))); });
  for (const MapCase& c : kMapCases)
    register_once(c.name, session, [&] { return compare_maps(device, c.robots, c.range, c.weighs, kMapTurns); });
}

void register_all(Session& session) {
  const auto add = [&session](const char* name, const char* file, auto measure) {
    register_once(name, session,
                  [&session, file, measure] { return measurement_report(file, measure(session.device)); });
  };
  // Must run first: a child process counts at least the resident memory of its parent.
  add("price/program", "prices", [](gpu::Device&) { return measure_program(); });
  register_comparisons(session);
  add("start", "facts", [](gpu::Device&) { return measure_start(); });
  add("price/features", "prices", measure_features);
  add("small_ticks", "facts", measure_ticks);
  add("fleets", "facts", measure_fleets);
  add("beside_stage", "facts", measure_beside_stage);
  add("lists", "facts", measure_lists);
}

int run(int argc, char** argv) {
  std::string folder, pictures;
  benchmark::Initialize(&argc, argv);
  for (int i = 1; i < argc; ++i)
    if (std::strncmp(argv[i], "--results=", 10) == 0)
      folder = argv[i] + 10;
    else if (std::strncmp(argv[i], "--pictures=", 11) == 0)
      pictures = argv[i] + 11;
    else
      throw base::InputError(std::string(argv[i]) +
                             ": expected --results=FOLDER, --pictures=FOLDER or an option of Google Benchmark");
  Session session;
  benchmark::AddCustomContext("device", session.device.info().name + ", " + session.device.info().driver);
  register_all(session);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  if (!folder.empty()) write_csv(session.reports, folder);
  if (!pictures.empty()) draw_curves(session.curves, pictures);
  fmt::print("{}", tables(session.reports));
  return 0;
}

}  // namespace

}  // namespace sf::bench

int main(int argc, char** argv) {
  try {
    return sf::bench::run(argc, argv);
  } catch (const sf::base::DeviceError& error) {
    fmt::print(stderr, "sensorfarm_bench: {}\n", error.what());
    return 3;
  } catch (const sf::base::InputError& error) {
    fmt::print(stderr, "sensorfarm_bench: {}\n", error.what());
    return 2;
  }
}
