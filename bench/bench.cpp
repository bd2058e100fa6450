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
#include "bench/fleet_runs.h"
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

/// Results that are measured once and reported several times.
struct Session {
  gpu::Device device;
  Book book;
  std::map<std::string, Comparison> comparisons;
  std::vector<FieldComparison> fields;
  std::vector<LaneComparison> lanes;
  std::vector<ConeComparison> cones;
  std::vector<MapComparison> maps;
  std::vector<AccuracyModeComparison> accuracy_modes;
  std::vector<LargeFleetResult> large_fleets;
  std::vector<Curve> curves;
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
  session.book.scans.push_back(comparison);
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
  session.book.ticks.push_back(result);
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

void report_field(benchmark::State& state, Session& session, const FieldCase& c) {
  for (auto _ : state) session.fields.push_back(compare(c.scene(), session.device));
  for (const FieldMethodResult& e : session.fields.back().method_results)
    state.counters[e.method + " [ms]"] = 1e3 * e.typical.wall_s;
}

struct LaneCase {
  const char* name;
  double resolution;  ///< [m] 0: exact markings
};
constexpr LaneCase kLaneCases[] = {
    {"laneedge/exact/10000", 0.0}, {"laneedge/raster_5mm/10000", 0.005}, {"laneedge/raster_20mm/10000", 0.02}};
constexpr std::size_t kLaneTurns = 15;

void report_lanes(benchmark::State& state, Session& session, const LaneCase& c) {
  const LaneScene scene = make_lane_scene(20, 10'000, c.resolution);
  for (auto _ : state) session.lanes.push_back(compare_lanes(session.device, scene, kLaneTurns));
  for (const LaneMethodResult& e : session.lanes.back().method_results)
    state.counters[e.method + " [ms]"] = 1e3 * e.typical.wall_s;
}

constexpr std::uint32_t kConeCases[] = {100, 1'000};
constexpr std::size_t kConeTurns = 31;

void report_cones(benchmark::State& state, Session& session, std::uint32_t robots) {
  for (auto _ : state) session.cones.push_back(compare_cones(session.device, make_cone_scene(robots), kConeTurns));
  for (const ConeMethodResult& e : session.cones.back().method_results)
    state.counters[e.method + " [ms]"] = 1e3 * e.typical.wall_s;
}

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

void report_maps(benchmark::State& state, Session& session, const MapCase& c) {
  for (auto _ : state) session.maps.push_back(compare_maps(session.device, c.robots, c.range, c.weighs, kMapTurns));
  for (const MapMethodResult& e : session.maps.back().method_results)
    state.counters[e.method + " [ms]"] = 1e3 * e.typical.wall_s;
}

constexpr std::uint32_t kLargeFleet = 10'000;
constexpr std::size_t kLargeFleetTicks = 60;

void report_large_fleet(benchmark::State& state, Session& session) {
  for (auto _ : state) session.large_fleets.push_back(drive_large_fleet(session.device, kLargeFleet, kLargeFleetTicks));
  state.counters["p50 [ms]"] = 1e3 * session.large_fleets.back().p50_s;
  state.counters["p99 [ms]"] = 1e3 * session.large_fleets.back().p99_s;
}

struct CurveCase {
  const char* name;
  Curve (*measure)(gpu::Device& device);
};
constexpr CurveCase kCurveCases[] = {
    {"curves/standing", [](gpu::Device& device) { return robots_curve(device, false, 100'000); }},
    {"curves/wandering", [](gpu::Device& device) { return robots_curve(device, true, 30'000); }},
    {"curves/city", [](gpu::Device& device) { return segments_curve(device, 10'000'000); }}};

void report_curve(benchmark::State& state, Session& session, const CurveCase& c) {
  for (auto _ : state) session.curves.push_back(c.measure(session.device));
  state.counters["exponent"] = session.curves.back().exponent;
}

constexpr double kModeRanges[] = {8.0, 0.75};
constexpr std::uint32_t kModeRobots = 1'000;
constexpr std::size_t kModeTurns = 21;

void report_accuracy_modes(benchmark::State& state, Session& session, double range) {
  for (auto _ : state)
    session.accuracy_modes.push_back(compare_accuracy_modes(session.device, kModeRobots, range, kModeTurns));
  for (const AccuracyModeResult& e : session.accuracy_modes.back().entries)
    state.counters[e.method + " [ms]"] = 1e3 * e.typical.wall_s;
}

void report_measurements(benchmark::State& state, std::vector<Measurement>& facts,
                         const std::function<std::vector<Measurement>()>& measure) {
  for (auto _ : state)
    for (const Measurement& fact : measure()) {
      state.counters[fact.what] = fact.value;
      facts.push_back(fact);
    }
}

const char* method_key(std::size_t which) {
  constexpr const char* kKeys[kMethods] = {"farm",           "grid",     "grid_native",     "embree8",
                                           "embree8_robust", "embree16", "embree16_robust", "embree1"};
  return kKeys[which];
}

void register_all(Session& session) {
  const auto once = [](benchmark::internal::Benchmark* b) { b->Unit(benchmark::kMillisecond)->Iterations(1); };
  std::vector<Measurement>& facts = session.book.facts;
  std::vector<Measurement>& prices = session.book.prices;
  // Must run first: a child process counts at least the resident memory of its parent.
  once(benchmark::RegisterBenchmark(
      "price/program", [&prices](benchmark::State& s) { report_measurements(s, prices, measure_program); }));
  for (const ScanCase& c : kScanCases)
    for (std::size_t which = 0; which < kMethods; ++which)
      benchmark::RegisterBenchmark(fmt::format("scan/cave/{}/{}m/{}", c.robots, c.range, method_key(which)).c_str(),
                                   [&session, &c, which](benchmark::State& s) { report_scan(s, session, c, which); })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond)
          ->Iterations(static_cast<benchmark::IterationCount>(c.repeats));
  for (const TickCase& c : kTickCases)
    benchmark::RegisterBenchmark(
        fmt::format("tick/{}/{}m/{}", c.robots, c.range, c.wander ? "wandering" : "standing").c_str(),
        [&session, &c](benchmark::State& s) { report_ticks(s, session, c); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(static_cast<benchmark::IterationCount>(c.ticks));
  for (const FieldCase& c : kFieldCases)
    once(benchmark::RegisterBenchmark(c.name, [&](benchmark::State& s) { report_field(s, session, c); }));
  for (const LaneCase& c : kLaneCases)
    once(benchmark::RegisterBenchmark(c.name, [&](benchmark::State& s) { report_lanes(s, session, c); }));
  for (const std::uint32_t robots : kConeCases)
    once(benchmark::RegisterBenchmark(fmt::format("sonar/cave/{}", robots).c_str(),
                                      [&session, robots](benchmark::State& s) { report_cones(s, session, robots); }));
  for (const double range : kModeRanges)
    once(benchmark::RegisterBenchmark(
        fmt::format("accuracy_modes/cave/{}/{}m", kModeRobots, range).c_str(),
        [&session, range](benchmark::State& s) { report_accuracy_modes(s, session, range); }));
  once(benchmark::RegisterBenchmark(fmt::format("large_fleet/{}", kLargeFleet).c_str(),
                                    [&session](benchmark::State& s) { report_large_fleet(s, session); }));
  for (const CurveCase& c : kCurveCases)
    once(benchmark::RegisterBenchmark(c.name, [&](benchmark::State& s) { report_curve(s, session, c); }));
  for (const MapCase& c : kMapCases)
    once(benchmark::RegisterBenchmark(c.name, [&](benchmark::State& s) { report_maps(s, session, c); }));
  once(benchmark::RegisterBenchmark("start",
                                    [&facts](benchmark::State& s) { report_measurements(s, facts, measure_start); }));
  once(benchmark::RegisterBenchmark("price/features", [&](benchmark::State& s) {
    report_measurements(s, prices, [&session] { return measure_features(session.device); });
  }));
  once(benchmark::RegisterBenchmark("small_ticks", [&](benchmark::State& s) {
    report_measurements(s, facts, [&session] { return measure_ticks(session.device); });
  }));
  once(benchmark::RegisterBenchmark("fleets", [&](benchmark::State& s) {
    report_measurements(s, facts, [&session] { return measure_fleets(session.device); });
  }));
  once(benchmark::RegisterBenchmark("beside_stage", [&](benchmark::State& s) {
    report_measurements(s, facts, [&session] { return measure_beside_stage(session.device); });
  }));
  once(benchmark::RegisterBenchmark("lists", [&](benchmark::State& s) {
    report_measurements(s, facts, [&session] { return measure_lists(session.device); });
  }));
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
  if (!folder.empty()) {
    write_csv(session.book, folder);
    write_csv(session.fields, folder);
    write_lanes(session.lanes, folder);
    write_cones(session.cones, folder);
    write_maps(session.maps, folder);
    write_accuracy_modes(session.accuracy_modes, folder);
    write_large_fleet(session.large_fleets, folder);
    write_curves(session.curves, folder);
  }
  if (!pictures.empty()) draw_curves(session.curves, pictures);
  fmt::print("{}{}{}{}{}{}{}{}", tables(session.book), table(session.fields), lane_table(session.lanes),
             cone_table(session.cones), map_table(session.maps), accuracy_mode_table(session.accuracy_modes),
             large_fleet_table(session.large_fleets), curves_table(session.curves));
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
