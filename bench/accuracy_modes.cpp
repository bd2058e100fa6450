#include "bench/accuracy_modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "bench/approximations.h"
#include "bench/farm_caster.h"
#include "bench/report.h"
#include "sensors/accuracy.h"
#include "sensors/laser_modes.h"
#include "tests/sensors/scenes.h"

namespace sf::bench {

namespace {

constexpr double kCells[] = {0.03, 0.1};  // [m] of distance grids

AccuracyModeResult entry_of(const MethodResult& method_result, const Caster& caster, const Caster& exact,
                            const Scans& scans) {
  AccuracyModeResult entry{method_result};
  std::vector<double> errors;
  for (std::size_t i = 0; i < scans.robots(); ++i)
    for (std::size_t k = 0; k < scans.beams.size(); ++k)
      errors.push_back(std::abs(caster.range(i, k) - exact.range(i, k)));
  std::sort(errors.begin(), errors.end());
  entry.median = errors[errors.size() / 2];
  entry.p99 = errors[errors.size() * 99 / 100];
  entry.max = errors.back();
  return entry;
}

}  // namespace

AccuracyModeComparison compare_accuracy_modes(gpu::Device& device, std::uint32_t robots, double range,
                                              std::size_t repeats) {
  std::deque<Scans> scans;
  std::vector<std::unique_ptr<Caster>> casters;
  for (const sensors::AccuracyMode& mode : sensors::kLaserModes) {
    scans.push_back(make_scans("cave", load_cave(), robots, scenes::laser(361, M_PI, range)));
    sensors::set_accuracy(scans.back().world, std::string(mode.word));
    casters.push_back(make_farm_caster(scans.back(), device, std::string(mode.word)));
  }
  for (const double cell : kCells) casters.push_back(make_march_caster(scans.front(), cell));
  const std::size_t last = (repeats - 1) % scans.front().rounds.size();
  const auto before = make_farm_caster(scans.front(), device, "before");
  before->cast((last + scans.front().rounds.size() - 1) % scans.front().rounds.size());
  casters.push_back(make_predicting_caster(scans.front(), *before,
                                           (last + scans.front().rounds.size() - 1) % scans.front().rounds.size()));

  const Comparison comparison = compare(scans.front(), casters, "exact", repeats);
  AccuracyModeComparison result{robots, range, {}};
  for (std::size_t i = 0; i < casters.size(); ++i)
    result.entries.push_back(entry_of(comparison.method_results[i], *casters[i], *casters.front(), scans.front()));
  return result;
}

std::string accuracy_mode_table(const std::vector<AccuracyModeComparison>& comparisons) {
  std::string text;
  for (const AccuracyModeComparison& o : comparisons) {
    text += fmt::format(
        "\n{} robots, {:g} m\n\n| | cpu ms | clock ms | exact / it, by cpu and clock | median error | 99 % | "
        "largest |\n|---|---|---|---|---|---|---|\n",
        o.robots, o.range_m);
    for (const AccuracyModeResult& e : o.entries)
      text += fmt::format("| {} | {:.1f} | {:.1f} | {:.2f}, {:.2f} | {:.2g} m | {:.2g} m | {:.2g} m |\n", e.method,
                          1e3 * e.typical.cpu_s, 1e3 * e.typical.wall_s, e.cpu_ratio, e.ratio, e.median, e.p99, e.max);
  }
  return text;
}

void write_accuracy_modes(const std::vector<AccuracyModeComparison>& comparisons, const std::string& folder) {
  if (comparisons.empty()) return;
  std::string text = "robots,range_m,method,cpu_ms,wall_ms,cpu_ratio,ratio,median_error_m,p99_error_m,max_error_m\n";
  for (const AccuracyModeComparison& o : comparisons)
    for (const AccuracyModeResult& e : o.entries)
      text += fmt::format("{},{:g},\"{}\",{:.3f},{:.3f},{:.3f},{:.3f},{:.3g},{:.3g},{:.3g}\n", o.robots, o.range_m,
                          e.method, 1e3 * e.typical.cpu_s, 1e3 * e.typical.wall_s, e.cpu_ratio, e.ratio, e.median,
                          e.p99, e.max);
  write(folder + "/accuracy_modes.csv", text);
}

}  // namespace sf::bench
