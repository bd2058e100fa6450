#pragma once
// Experiments by name: trials with different seeds, statistics beside the thesis', figures, one folder.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gpu/device.h"
#include "scenarios/scenario.h"
#include "scenarios/trial.h"

namespace sf::scenarios {

struct ExperimentOptions {
  std::uint32_t trials = 3;
  std::uint64_t seed = 1;      ///< trial k has seed + k
  std::optional<Plant> plant;  ///< else the experiment's own
  std::string folder;          ///< with the scenarios' files
  std::string out;             ///< folder to write into
  unsigned threads = 0;
  std::function<void(const std::string& world, const std::vector<world::Warning>&)> warn;  ///< what its world warns of
  std::function<bool()> stop;  ///< asked often; may be empty
};

struct ExperimentType;

/// What an experiment is asked to do, and with what.
struct ExperimentContext {
  const ExperimentType& kind;
  const Scenario& scenario;
  const ExperimentOptions& options;
  gpu::Device& device;
  std::function<void(double, const std::string&)> progress;  ///< part in [0, 1] that is done, and what is next
};

struct ExperimentType {
  std::string_view name;
  std::string_view scenario;   ///< stem of its file in the folder; empty: its name
  std::string_view summary;    ///< one line for help
  Plant plant = Plant::ideal;  ///< unless the user or the scenario says otherwise
  /// A few sentences for its report: why its numbers are not the thesis', or what they show.
  std::string_view reasons;
  /// Writes its files into the folder, and gives their names.
  std::vector<std::string> (*run)(const ExperimentContext& context);
};

std::span<const ExperimentType* const> experiments();
/// Null when there is none of that name.
const ExperimentType* find_experiment(std::string_view name);

/// Reads the scenario, runs, writes. @return the files written
/// @throws base::InputError for a folder that cannot be written, or a scenario that cannot be run; Interrupted when
/// `options.stop` says so: trials that were whole by then are kept, nothing else is written.
std::vector<std::string> run_experiment(const ExperimentType& kind, const ExperimentOptions& options,
                                        gpu::Device& device,
                                        const std::function<void(double, const std::string&)>& progress);

// --- For experiments -------------------------------------------------------------------------------------------------

/// Every trial of the bench, each in `trial-<k>/` of its folder, one after another.
std::vector<Trial> run_trials(const ExperimentContext& context, const TrialOptions& options);
/// Path of a file in the experiment's folder.
std::string in_folder(const ExperimentContext& context, const std::string& name);
/// Makes a folder that the user named with -o, and those above it, where it is not there.
/// @throws base::InputError naming it when it cannot be made.
void make_folder(const std::string& path);
/// @throws base::InputError naming the path when it cannot be written.
void write_text(const std::string& path, const std::string& text);
/// "3 trials", "1 trial".
std::string counted(std::uint64_t count, std::string_view one);
/// "plant `thesis`, seeds 1 to 3, link ...": what was run, for reports.
std::string setup_of(const ExperimentContext& context, const Disturbance& disturbance);

}  // namespace sf::scenarios
