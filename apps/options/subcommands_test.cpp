// Subcommands that test: experiments, scenarios, and the farm itself.

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>

#include "apps/commands/commands.h"
#include "apps/options/option_groups.h"
#include "apps/options/option_parsers.h"
#include "apps/options/subcommands.h"
#include "apps/processes/slurm.h"
#include "apps/reports/text.h"
#include "base/installation.h"
#include "scenarios/experiment.h"
#include "selftest/suite.h"

namespace sf::apps {

namespace {

/// Returns whether the option is set, and not by its environment variable, which is for all commands.
bool is_typed(const CLI::Option& option) {
  const char* environment = option.get_envname().empty() ? nullptr : std::getenv(option.get_envname().c_str());
  return option.count() > 0 && (environment == nullptr || option.results().front() != environment);
}

/// Experiments on measurements need --data and have no trials; only those with a scenario have its options.
void check_source(const CLI::App& sub) {
  if (sub.count("experiment") == 0) return;
  const std::string name = sub.get_option("experiment")->as<std::string>();
  const scenarios::ExperimentType& type = *scenarios::find_experiment(name);
  const scenarios::ExperimentSource source = type.source;
  const auto exclude = [&](std::initializer_list<const char*> options) {
    for (const char* option : options)
      if (is_typed(*sub.get_option(option)))
        throw CLI::ValidationError(option, fmt::format("is not for the experiment {}", name));
  };
  if (source != scenarios::ExperimentSource::measurements)
    exclude({"--data"});
  else if (sub.count("--data") == 0)
    throw CLI::RequiredError(fmt::format("--data, the folder that {} evaluates,", name));
  else
    exclude({"--trials", "--seed"});
  if (type.fixed_trials) exclude({"--trials"});
  if (source != scenarios::ExperimentSource::scenario) exclude({"--plant", "--compression", "--files", "--device"});
}

void add_experiment(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "experiment",
      "Run an experiment and write its trials, its statistics compared with the thesis, and its figures to one folder");
  auto& o = add_command(*sub, call, experiment, [sub] {
    if (sub->count("--list") + sub->count("experiment") == 0) throw CLI::RequiredError("experiment (or --list)");
    check_source(*sub);
  });
  add_examples(*sub, {"--list", "mapping -o out/mapping", "mrclam --data MRCLAM_Dataset6 -o out/mrclam"});
  auto* list = sub->add_flag("--list", o.list, "List all experiments");
  std::vector<std::string> names;
  for (const scenarios::ExperimentType* type : scenarios::experiments()) names.emplace_back(type->name);
  auto* name = sub->add_option("experiment", o.experiment, join_or(names))->check(one_of(names))->type_name("NAME");
  auto* out =
      sub->add_option("-o,--out", o.out, "Folder to write into")->check(not_empty("a folder"))->type_name("DIR");
  name->needs(out)->excludes(list);
  sub->add_option("--trials", o.trials, "Number of trials, each with its own seed")
      ->check(whole(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  add_seed(*sub, o, "Seed of the first trial");
  using scenarios::Plant;
  add_choice<std::optional<Plant>, Plant>(
      *sub, "--plant", o.plant, {{"thesis", Plant::thesis}, {"ideal", Plant::ideal}},
      "Actuator model of the robots: ideal (commands are executed unchanged) or thesis (Player's driver for the "
      "Create). Default: thesis for paths, sweeps and mapping; ideal for towns and Pioneers");
  add_compression(*sub, o);
  sub->add_option("--files", o.experiments, "Folder of the experiments' scenario files (default: sensorfarm's own)")
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  sub->add_option("--data", o.data, "Folder of the measurements that mrclam evaluates: an unpacked MRCLAM data set")
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  add_in_process(*sub, o);
  add_device(*sub, o);
}

void add_test(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("test", "Run scenarios and check their expectations (exit code 1 if one fails)");
  auto& o = add_command(*sub, call, test_scenarios);
  add_examples(*sub, {"experiments/mapping.toml --junit results.xml"});
  sub->add_option("scenario", o.scenarios, "Scenario files (.toml)")
      ->required()
      ->transform(base::installed_file)
      ->type_name("FILE");
  sub->add_option("--junit", o.junit, "Write the results as JUnit XML")
      ->check(new_file("junit.xml"))
      ->type_name("FILE");
  sub->add_option("--jobs", o.jobs, "Number of scenarios to run in parallel, each in its own process")
      ->check(whole(1, 1024))
      ->type_name("N")
      ->capture_default_str();
  add_timeout(*sub, o.timeout, "scenario");
  add_in_process(*sub, o);
  add_device(*sub, o);
}

void add_sweep(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "sweep",
      "Run a scenario over a grid or a sample of parameters, with several seeds per point, into one folder; a repeated "
      "call runs only the missing jobs (exit code 1 if a job fails or misses an expectation)");
  auto& o = add_command(*sub, call, sweep, [sub] {
    if (sub->count("--out") + sub->count("--list") == 0) throw CLI::RequiredError("--out (or --list)");
  });
  add_examples(*sub, {"experiments/sweeps/lane-edge.toml -o out/sweep",
                      "experiments/sweeps/lane-edge.toml -o out/sweep --slurm"});
  sub->add_option("sweep", o.file, "Sweep file (.toml; docs/sweeps.md)")
      ->required()
      ->transform(base::installed_file)
      ->type_name("FILE");
  auto* out = sub->add_option("-o,--out", o.out, "Folder for results and tables; several machines may share it")
                  ->check(not_empty("a folder"))
                  ->type_name("DIR");
  auto* list =
      sub->add_flag("--list", o.list, "Print the points and the number of jobs without running any")->excludes(out);
  sub->add_option("--jobs", o.jobs, "Number of processes (default: one per core; in Slurm, SLURM_CPUS_PER_TASK)")
      ->check(whole(1, 1024))
      ->type_name("N");
  auto* share =
      sub->add_option("--share", o.share, "Run one of N shares, e.g. 2/8 (default: all; under srun, the task's share)")
          ->check(readable(read_share, "a share K/N, such as 2/8"))
          ->excludes(list)
          ->type_name("K/N");
  auto* retry = sub->add_flag("--retry", o.retry, "Rerun failed jobs")->excludes(list);
  auto* merge = sub->add_flag("--merge", o.merge,
                              "Write the tables of existing results without running jobs; missing jobs are marked")
                    ->excludes(list)
                    ->excludes(share)
                    ->excludes(retry);
  sub->add_flag_callback(
         "--no-plots", [&o] { o.plots = false; }, "Write tables only; `plot DIR` draws the plots later")
      ->excludes(list);
  auto* slurm = sub->add_flag("--slurm", o.slurm,
                              "Write the batch script of a Slurm job array for the missing jobs without running any")
                    ->excludes(list)
                    ->excludes(share)
                    ->excludes(merge);
  sub->add_option("--tasks", o.tasks, "Maximum number of tasks in the job array")
      ->check(whole(1, 100'000))
      ->needs(slurm)
      ->capture_default_str()
      ->type_name("N");
  sub->add_option("--sbatch", o.sbatch,
                  "Option of sbatch to add to the script, e.g. --sbatch=--time=1:00:00; may be repeated")
      ->needs(slurm)
      ->expected(1)
      ->type_name("OPTION");
  add_timeout(*sub, o.timeout, "job");
  add_in_process(*sub, o);
  add_device(*sub, o);
}

void add_merge(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("merge", "Merge the recordings of a run's ranks (docs/cluster.md)");
  auto& o = add_command(*sub, call, merge);
  add_examples(*sub, {"out/run -o out/whole"});
  sub->add_option("places", o.places, "Folders that contain rank-0.mcap, rank-1.mcap, ..., or the files themselves")
      ->required()
      ->type_name("DIR");
  sub->add_option("-o,--out", o.out, "Folder for the merged recording (run.mcap)")
      ->required()
      ->check(not_empty("a folder"))
      ->type_name("DIR");
}

void add_verify(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("verify",
                                     "Recompute a recorded run on this device and in plain C++, and compare bit by bit "
                                     "(exit code 1 if anything differs)");
  auto& o = add_command(*sub, call, verify);
  add_examples(*sub, {"out/run"});
  add_recording(*sub, o);
  auto* sample = sub->add_option("--sample", o.sample,
                                 "Number of laser scans to recompute in plain C++, spread over the run (0: all)")
                     ->check(whole(0, UINT64_MAX))
                     ->type_name("N")
                     ->capture_default_str();
  sub->add_flag_callback(
         "--all", [&o] { o.sample = 0; }, "Recompute every laser scan in plain C++, which may take a long time")
      ->excludes(sample);
  add_accuracy(
      *sub, o.accuracy,
      "Also recompute the run in another accuracy mode, and print the distribution of its errors relative to exact");
  add_threads(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
}

void add_tradeoff(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "tradeoff", "Measure the speed and error of every accuracy mode of a world's sensors on this machine");
  auto& o = add_command(*sub, call, tradeoff, [sub] {
    require_any(*sub, kPageOptions, {"--out"});
    require_any(*sub, {"--format"}, {"--out"});
  });
  add_examples(*sub, {"worlds/cave.world --max-error 5mm"});
  add_world(*sub, o);
  sub->add_option("-o,--out", o.out, "Folder for tradeoff.csv and the picture, tradeoff.png")
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  add_format(*sub, o.format);
  add_page(*sub, o);
  add_accuracy_target(*sub, o);
  sub->add_flag("--auto", o.automatic, "Print only the words for --accuracy, for scripts");
  add_json(*sub, o);
  add_device(*sub, o);
  add_robots(*sub, o);
  add_robot_from(*sub, o);
  add_threads(*sub, o);
}

bool is_case_or_group(const std::string& name) {
  const auto all = selftest::cases();
  return name == selftest::failing_case().name || std::any_of(all.begin(), all.end(), [&](const selftest::Case& c) {
           return c.name == name || c.group == name;
         });
}

void add_selftest(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("selftest",
                                     "Test the farm on this machine at the limits of its range: worlds, beams, "
                                     "magnets, times, numbers (exit code 1 if an answer is wrong)");
  auto& o = add_command(*sub, call, selftest);
  add_examples(*sub, {"--list"});
  auto* list = sub->add_flag("--list", o.list, "List all cases with their expected answers");
  sub->add_option("case", o.cases, "Cases or groups of cases (default: all)")
      ->check([](const std::string& name) {
        return is_case_or_group(name)
                   ? std::string()
                   : "'" + name + "' is neither a case nor a group; `sensorfarm selftest --list` lists them";
      })
      ->type_name("NAME")
      ->excludes(list);
  add_json(*sub, o);
  add_device(*sub, o);
}

}  // namespace

void add_test_commands(CLI::App& app, Call& call) {
  add_experiment(app, call);
  add_test(app, call);
  add_sweep(app, call);
  add_merge(app, call);
  add_verify(app, call);
  add_tradeoff(app, call);
  add_selftest(app, call);
}

}  // namespace sf::apps
