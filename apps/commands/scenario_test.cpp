// `test`: runs scenarios, checks their expectations, and reports the results as a table and JUnit XML.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "apps/commands/commands.h"
#include "apps/commands/output_file.h"
#include "apps/commands/rank_run.h"
#include "apps/options/open_device.h"
#include "apps/processes/scenario_processes.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/printable.h"
#include "base/thread_pool.h"
#include "cluster/shares.h"
#include "scenarios/junit.h"

namespace sf::apps {

namespace {

const char* word_of(scenarios::ScenarioStatus status) {
  return status == scenarios::ScenarioStatus::passed   ? "pass"
         : status == scenarios::ScenarioStatus::failed ? "FAIL"
                                                       : "none";
}

std::string scenario_result_text(const scenarios::ScenarioResult& result) {
  if (!result.failure.empty())
    return fmt::format("{} {}: {}\n  FAIL {}\n", word_of(result.status()), result.file, result.name, result.failure);
  std::string text = fmt::format("{} {}: {:.1f} s simulated in {:.2f} s, {}\n", word_of(result.status()), result.file,
                                 result.simulated, result.wall, result.name);
  for (const scenarios::ExpectationResult& o : result.outcomes)
    text +=
        fmt::format("  {} {:<28} expected {:<14} got {}\n", o.met ? "pass" : "FAIL", o.what, o.expected, o.measured);
  if (result.outcomes.empty()) text += "  nothing expected; see [expect] in docs/scenarios.md\n";
  return text;
}

/// Returns the result of the first rank: times, which a scenario can limit, differ between ranks.
bool agreed(bool passed, cluster::Ranks* ranks) {
  if (ranks == nullptr) return passed;
  const std::array<std::uint8_t, 1> word{passed};
  return ranks->exchange(word).front().front() != 0;
}

bool none_failed(std::span<const scenarios::ScenarioResult> results) {
  return std::all_of(results.begin(), results.end(), [](const scenarios::ScenarioResult& result) {
    return result.status() != scenarios::ScenarioStatus::failed;
  });
}

/// Reports unfinished scenarios as failures in JUnit.
void add_interrupted(const TestOptions& options, std::vector<scenarios::ScenarioResult>& results) {
  print_message("interrupted: {} of {} run", results.size(), counted(options.scenarios.size(), "scenario"));
  for (std::size_t i = results.size(); i < options.scenarios.size(); ++i)
    results.push_back({.name = options.scenarios[i], .file = options.scenarios[i], .failure = "interrupted"});
}

/// Runs the scenarios until a stop is requested. @return false if stopped
bool run_all(const std::vector<scenarios::Scenario>& all, gpu::Device& device, cluster::Ranks* ranks, bool reports,
             std::vector<scenarios::ScenarioResult>& results) {
  try {
    for (const scenarios::Scenario& scenario : all) {
      {
        Progress progress(scenario.name);
        const auto show = [&](double part) {
          if (reports) progress.show(part);
        };
        results.push_back(scenarios::run_scenario(scenario, device, show, cluster::threads_of(0, ranks), ranks,
                                                  [] { return stop_requested().load(); }));
      }
      print(base::printable(scenario_result_text(results.back())));
    }
  } catch (const base::Interrupted&) {
    return false;
  }
  return true;
}

/// Runs them one after another in this process, which may share the fleets with other ranks.
int test_here(const TestOptions& options, cluster::Ranks* ranks) {
  const bool reports = ranks == nullptr || ranks->rank() == 0;
  install_stop_handlers();
  std::vector<scenarios::Scenario> all;
  std::optional<gpu::Device> device;
  // Read all files and check what they need before running any, so that an error in the last file is reported at once.
  on_all(ranks, [&] {
    for (const std::string& file : options.scenarios) all.push_back(scenarios::read_scenario(file));
    for (const scenarios::Scenario& scenario : all) print_warnings(scenario.world, scenarios::check_scenario(scenario));
    if (!options.junit.empty() && reports) check_writable(options.junit);
    device.emplace(open_device(options));
  });
  std::vector<scenarios::ScenarioResult> results;
  const bool whole = run_all(all, *device, ranks, reports, results);
  const bool fine = none_failed(results);
  if (!whole && reports) add_interrupted(options, results);
  on_all(ranks, [&] {
    if (!options.junit.empty() && reports) write_text(options.junit, scenarios::junit_of(results));
  });
  if (!agreed(fine, ranks)) return 1;
  return whole ? 0 : interrupted_code();
}

int test_in_processes(const TestOptions& options) {
  std::vector<scenarios::ScenarioResult> results;
  const bool whole = run_in_own_processes(
      options,
      [&] {
        if (!options.junit.empty()) check_writable(options.junit);
      },
      [&](const scenarios::ScenarioResult& result) {
        results.push_back(result);
        print(base::printable(scenario_result_text(result)));
      });
  const bool fine = none_failed(results);
  if (!whole) add_interrupted(options, results);
  if (!options.junit.empty()) write_text(options.junit, scenarios::junit_of(results));
  if (!fine) return 1;
  return whole ? 0 : interrupted_code();
}

}  // namespace

int test_scenarios(const TestOptions& options) {
  if (!cluster::is_rank() && !options.in_process) return test_in_processes(options);
  return with_ranks([&](cluster::Ranks* ranks) { return test_here(options, ranks); });
}

}  // namespace sf::apps
