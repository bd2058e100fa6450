#include "bench/curves.h"

#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "bench/tick_benchmark.h"
#include "bench/tiles.h"
#include "tests/sensors/scenes.h"
#include "viz/series_figure.h"

namespace sf::bench {

namespace {

constexpr std::size_t kWarmUp = 5;

/// [byte] Returns the resident memory after returning freed memory to the system.
double resident() {
  malloc_trim(0);
  std::size_t pages = 0;
  std::ifstream statm("/proc/self/statm");
  statm >> pages >> pages;
  return static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// Fits log(cpu) over log(count) by least squares. Skips counts below a full tile, since their density is lower.
double exponent_of(const std::vector<CurvePoint>& points) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const CurvePoint& p : points) {
    if (p.count < kRobotsPerTile) continue;
    const double u = std::log(p.count), v = std::log(p.cpu_s);
    n += 1.0, x += u, y += v, xx += u * u, xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

template <class Make>
CurvePoint measure(gpu::Device& device, double count, bool wander, std::size_t ticks, Make&& make) {
  CurvePoint point{.count = count};
  const double before = resident();
  const world::World world = make();
  const double start = now().wall_s;
  TickBenchmark fleet(world, device);
  fleet.tick(wander);
  point.load_s = now().wall_s - start;
  for (std::size_t k = 1; k < kWarmUp; ++k) fleet.tick(wander);
  std::vector<Cost> costs;
  for (std::size_t k = 0; k < ticks; ++k) {
    const Cost begun = now();
    fleet.tick(wander);
    costs.push_back(since(begun));
  }
  point.wall_s = median(costs).wall_s;
  point.cpu_s = median(costs).cpu_s;
  point.memory = resident() - before;
  return point;
}

/// Creates a city of `segments` / 4 square blocks. The world's extent is that of the robots: ten blocks across, in the
/// middle.
world::World city(std::size_t segments) {
  constexpr double kPitch = 10.0, kBlock = 6.0;  // [m]
  world::World world;
  world.models.push_back({"city", "model"});
  const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(segments) / 4.0)));
  world.walls.reserve(4 * side * side);
  const double half = 0.5 * kPitch * static_cast<double>(side);
  for (std::size_t i = 0; i < side * side && world.walls.size() < segments; ++i) {
    const glm::dvec2 low{kPitch * static_cast<double>(i % side) - half, kPitch * static_cast<double>(i / side) - half};
    const glm::dvec2 high = low + glm::dvec2{kBlock, kBlock};
    const glm::dvec2 corners[] = {low, {high.x, low.y}, high, {low.x, high.y}};
    for (std::size_t k = 0; k < 4; ++k) {
      world::Segment wall;
      wall.a = corners[k], wall.b = corners[(k + 1) % 4], wall.z_max = 1.0;
      world.walls.push_back(wall);
    }
  }
  world.extent = {-half, -half, half, half};
  return world;
}

/// Adds robots at the crossings and streets nearest to the centre, a metre apart.
void add_walkers(world::World& world, std::uint32_t count) {
  const double low = std::max(world.extent.x_min, -50.0) + 8.0;  // middle of a street
  for (std::uint32_t i = 0; i < count; ++i)
    scenes::add_robot(world, {low + 10.0 * (i % 5), low + 2.0 * (i / 5), 0.0, 0.3 * i}, scenes::laser());
}

}  // namespace

Curve robots_curve(gpu::Device& device, bool wander, std::uint32_t most) {
  Curve curve{wander ? "wandering robots" : "standing robots", "robots", {}, 0.0};
  for (const std::uint32_t robots : {10u, 30u, 100u, 300u, 1'000u, 3'000u, 10'000u, 30'000u, 100'000u}) {
    if (robots > most) break;
    const std::size_t ticks = std::clamp<std::size_t>(100'000 / robots, 5, 200);
    curve.points.push_back(
        measure(device, robots, wander, ticks, [robots] { return tiled_cave(robots, scenes::laser()); }));
  }
  curve.exponent = exponent_of(curve.points);
  return curve;
}

Curve segments_curve(gpu::Device& device, std::size_t most) {
  Curve curve{"100 robots in a city", "segments", {}, 0.0};
  for (std::size_t segments = 100; segments <= most; segments *= 10)
    curve.points.push_back(measure(device, static_cast<double>(segments), true, 100, [segments] {
      world::World world = city(segments);
      add_walkers(world, 100);
      return world;
    }));
  curve.exponent = exponent_of(curve.points);
  return curve;
}

Report curve_report(const Curve& curve) {
  Report report{"curves", "", "curve,unit,count,wall_ms_median,cpu_ms_median,load_s,memory_mib,exponent"};
  report.counters = {{"exponent", curve.exponent}};
  report.text =
      fmt::format("\n{}: cpu time grows with the power {:.2f} of {}\n{:>12} {:>10} {:>10} {:>10} {:>12}\n", curve.what,
                  curve.exponent, curve.unit, curve.unit, "wall ms", "cpu ms", "load s", "memory MiB");
  for (const CurvePoint& p : curve.points) {
    const double wall = 1e3 * p.wall_s, cpu = 1e3 * p.cpu_s, memory = p.memory / (1u << 20);
    report.rows += fmt::format("{},{},{:.0f},{:.4f},{:.4f},{:.4f},{:.1f},{:.3f}\n", curve.what, curve.unit, p.count,
                               wall, cpu, p.load_s, memory, curve.exponent);
    report.text +=
        fmt::format("{:>12.0f} {:>10.3f} {:>10.3f} {:>10.3f} {:>12.1f}\n", p.count, wall, cpu, p.load_s, memory);
  }
  return report;
}

void draw_curves(const std::vector<Curve>& curves, const std::string& folder) {
  if (curves.empty()) return;
  viz::SeriesOptions options;
  options.title = "Cost of a tick";
  options.subtitle = "361 beams to 8 m a robot; a line's slope is the exponent of growth";
  options.x_name = "robots or segments, as powers of ten";
  viz::Panel time{"", "CPU time [ms], as powers of ten", {}, false},
      memory{"", "memory [MiB], as powers of ten", {}, false};
  for (const Curve& curve : curves) {
    viz::Series cost{fmt::format("{} (exponent {:.2f})", curve.what, curve.exponent), {}, {}}, held{curve.what, {}, {}};
    for (const CurvePoint& p : curve.points) {
      cost.times.push_back(std::log10(p.count));
      cost.values.push_back(std::log10(1e3 * p.cpu_s));
      held.times.push_back(std::log10(p.count));
      held.values.push_back(std::log10(std::max(p.memory, 65536.0) / (1u << 20)));
    }
    time.series.push_back(cost);
    memory.series.push_back(held);
  }
  options.panels = {time, memory};
  viz::draw_series(options, folder + "/cost.png");
}

}  // namespace sf::bench
