// A farm with a budget of processor time whose load doubles during the run: which readings are delivered, by priority.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <vector>

#include "base/time.h"
#include "farm/farm.h"
#include "robots/fleet.h"
#include "scenarios/experiment.h"

namespace sf::scenarios {

namespace {

constexpr std::uint8_t kLow = 2, kHigh = 8;  // priorities, of every other robot
constexpr double kSpin = 0.5;                // [rad/s] robots turn in place, so that no reading is reused
constexpr double kReserve = 1.2;             // budget over the cost of the first half

double processor_time() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// The ticks of one half of a run.
struct BudgetPhase {
  std::array<std::uint64_t, 2> due{}, delivered{}, stated{};  ///< by priority: low, high
  double seconds = 0.0, largest = 0.0;                        ///< [s] processor time of all ticks, of the longest
  double oldest = 0.0;                                        ///< [s] largest age of a delivered reading
  std::uint64_t ticks = 0;
};

world::World crowd_of(const ExperimentContext& context) {
  world::World world = world_of(context.scenario);
  for (std::uint32_t m = 0; m < world.movers.size(); ++m)
    for (world::Sensor& sensor : world.movers[m].sensors)
      sensor.settings.push_back({.key = "priority", .numbers = {static_cast<double>(m % 2 == 0 ? kLow : kHigh)}});
  return world;
}

/// @param budget [s] per tick; 0: none
std::array<BudgetPhase, 2> run_budget(const ExperimentContext& context, const world::World& world, double budget) {
  farm::Farm farm(world, context.device,
                  {.seed = context.options.seed, .threads = context.options.threads, .processor_budget = budget});
  std::vector<base::Report> reports = robots::states_at_load(world);
  const std::uint32_t half = static_cast<std::uint32_t>(world.movers.size() / 2);
  for (std::uint32_t m = 0; m < half; ++m) farm.subscribe(m, farm::kAllSensorTypes);
  std::array<BudgetPhase, 2> phases;
  const auto ticks = static_cast<std::int64_t>(context.scenario.duration / world.interval);
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    if (context.options.stop && context.options.stop()) throw Interrupted();
    if (tick == ticks / 2)
      for (std::uint32_t m = half; m < world.movers.size(); ++m) farm.subscribe(m, farm::kAllSensorTypes);
    const std::int64_t now = base::nanoseconds(world.interval * static_cast<double>(tick));
    for (base::Report& report : reports) {
      report.time = now;
      report.X_WM.yaw += kSpin * world.interval;
    }
    BudgetPhase& phase = phases[tick >= ticks / 2];
    const double before = processor_time();
    const auto readings = farm.tick(now, reports);
    const double took = processor_time() - before;
    if (tick < ticks / 4) continue;  // lists are built, and costs learnt
    ++phase.ticks;
    phase.seconds += took;
    phase.largest = std::max(phase.largest, took);
    for (const base::ReadingBlock& reading : readings) {
      ++phase.delivered[reading.mover % 2];
      phase.oldest = std::max(phase.oldest, 1e-9 * static_cast<double>(now - reading.time));
    }
    for (const farm::DroppedReading& reading : farm.dropped()) ++phase.stated[reading.mover % 2];
  }
  for (BudgetPhase& phase : phases)
    for (const std::size_t k : {0, 1}) phase.due[k] = phase.delivered[k] + phase.stated[k];
  return phases;
}

std::string budget_rows(const std::array<BudgetPhase, 2>& phases, double per_tick, bool csv) {
  std::string text;
  for (std::size_t p = 0; p < phases.size(); ++p)
    for (const std::size_t k : {1, 0}) {
      const BudgetPhase& phase = phases[p];
      const double share =
          static_cast<double>(phase.delivered[k]) / static_cast<double>(std::max<std::uint64_t>(phase.due[k], 1));
      const double mean = phase.seconds / static_cast<double>(phase.ticks);
      text += csv ? fmt::format("{},{},{},{},{:.4f},{:.4g},{:.4g},{:.4g},{:g}\n", p == 0 ? "half" : "all",
                                k == 1 ? kHigh : kLow, phase.due[k], phase.delivered[k], share, 1e3 * mean,
                                1e3 * phase.largest, 1e3 * per_tick, phase.oldest)
                  : fmt::format("| {} | {} | {} | {:.1f} % | {:.2f} | {:.1f} | {:g} |\n",
                                p == 0 ? "half of the robots" : "all robots", k == 1 ? kHigh : kLow, phase.due[k],
                                100.0 * share, mean / per_tick, phase.largest / per_tick, phase.oldest);
    }
  return text;
}

std::vector<std::string> run_budgets(const ExperimentContext& context) {
  if (!reports(context)) return {};
  const world::World world = crowd_of(context);
  if (context.progress) context.progress(0.0, "without a budget");
  const std::array<BudgetPhase, 2> free = run_budget(context, world, 0.0);
  const double per_tick = kReserve * free[0].seconds / static_cast<double>(free[0].ticks);  // [s]
  if (context.progress) context.progress(0.5, "with a budget");
  const std::array<BudgetPhase, 2> kept = run_budget(context, world, per_tick);
  const std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "report.md")};
  const std::string head =
      "| load | priority | due | delivered | mean time / budget | largest | oldest [s] |\n"
      "|---|---|---|---|---|---|---|\n";
  write_text(files[0], "load,priority,due,delivered,share,mean_ms,largest_ms,budget_ms,oldest_s\n" +
                           budget_rows(kept, per_tick, true));
  write_text(
      files[1],
      fmt::format("# A budget of processor time\n\nBudget: {:.1f} ms per tick, {:g} times what half of the robots "
                  "cost.\n\nWithout it:\n\n{}{}\nWith it:\n\n{}{}\n{}\n",
                  1e3 * per_tick, kReserve, head, budget_rows(free, per_tick, false), head,
                  budget_rows(kept, per_tick, false), context.type.reasons));
  return files;
}

constexpr std::string_view kBudgetReasons =
    "Times are of all threads of the process. Single ticks may exceed the budget, since a reading's cost is only known "
    "on average.";

}  // namespace

extern const ExperimentType budget_experiment;

constinit const ExperimentType budget_experiment{
    .name = "budget",
    .summary = "readings by priority when the load of a farm with a budget of processor time doubles",
    .fixed_trials = true,
    .reasons = kBudgetReasons,
    .run = run_budgets,
};

}  // namespace sf::scenarios
