// `experiment`: runs the trials of one experiment and writes the results to one folder.

#include "scenarios/experiment.h"
#include "apps/options/open_device.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <optional>

#include "apps/commands/commands.h"
#include "apps/commands/rank_run.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/installation.h"
#include "cluster/shares.h"
#include "scenarios/trial.h"

namespace sf::apps {

namespace {

namespace fs = std::filesystem;

/// Returns the requested folder, or the first `experiments` folder found in the working directory, above the program or
/// in its installation.
std::string folder_of(const ExperimentOptions& options) {
  if (!options.experiments.empty()) return options.experiments;
  std::error_code error;
  std::vector<fs::path> folders{fs::current_path(error)};
  for (fs::path at = fs::read_symlink("/proc/self/exe", error).parent_path(); at.has_relative_path();
       at = at.parent_path())
    folders.push_back(at);
  for (const fs::path& folder : folders)
    if (fs::exists(folder / "experiments" / "lane-edge-p.toml", error)) return (folder / "experiments").string();
  if (const fs::path shipped = base::installed_file("experiments/lane-edge-p.toml"); fs::exists(shipped, error))
    return shipped.parent_path().string();
  throw base::InputError(
      "cannot find the folder 'experiments' here, above the program or in the installation; name it with --files");
}

std::string needs_of(const scenarios::ExperimentType& type) {
  if (type.source == scenarios::ExperimentSource::measurements) return "needs --data";
  if (type.source == scenarios::ExperimentSource::model) return "no world";
  return fmt::format("plant {}", plant_name(type.plant));
}

int list_all() {
  for (const scenarios::ExperimentType* type : scenarios::experiments())
    print(fmt::format("{:<14} {}; {}\n", type->name, type->summary, needs_of(*type)));
  return 0;
}

int run_shared(const ExperimentOptions& options, cluster::Ranks* ranks) {
  scenarios::ExperimentOptions experiment_options{.trials = options.trials,
                                                  .seed = options.seed,
                                                  .plant = options.plant,
                                                  .data = options.data,
                                                  .out = options.out,
                                                  .compression = options.compression,
                                                  .threads = cluster::threads_of(0, ranks),
                                                  .ranks = ranks,
                                                  .warn = print_warnings,
                                                  .stop = [] { return stop_requested().load(); }};
  std::optional<gpu::Device> device;
  on_all(ranks, [&] {
    if (scenarios::find_experiment(options.experiment)->source != scenarios::ExperimentSource::scenario) {
      device.emplace(std::string(gpu::kHostDevice));
      return;
    }
    experiment_options.folder = folder_of(options);
    device.emplace(open_device(options));
  });
  install_stop_handlers();
  std::vector<std::string> files;
  try {
    Progress progress(options.experiment);
    files = scenarios::run_experiment(*scenarios::find_experiment(options.experiment), experiment_options, *device,
                                      [&](double part, const std::string& note) {
                                        if (ranks == nullptr || ranks->rank() == 0) progress.show(part, note);
                                      });
  } catch (const scenarios::Interrupted&) {
    const bool kept = std::filesystem::exists(options.out + "/trial-1");
    print_message("interrupted: no report was written{}",
                  kept ? fmt::format("; {} has the completed trials", options.out) : "");
    return interrupted_code();
  }
  for (const std::string& file : files) print_message("wrote {}", file);
  return 0;
}

}  // namespace

int experiment(const ExperimentOptions& options) {
  if (options.list) return list_all();
  return with_ranks([&](cluster::Ranks* ranks) { return run_shared(options, ranks); });
}

}  // namespace sf::apps
