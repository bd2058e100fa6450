#pragma once
// Named experiments: trials with different seeds, statistics compared with the thesis, and figures in one folder.

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
  std::uint64_t seed = 1;                                       ///< trial k has seed + k
  std::optional<Plant> plant;                                   ///< nullopt: the experiment's own
  std::string folder;                                           ///< contains the scenario files
  std::string data;                                             ///< folder of the measurements
  std::string out;                                              ///< output folder
  record::Compression compression = record::Compression::zstd;  ///< of recordings
  unsigned threads = 0;
  cluster::Ranks* ranks = nullptr;  ///< that share the fleets of all trials; null: none
  /// Called with warnings of the world file.
  std::function<void(const std::string& world, const std::vector<world::Warning>&)> warn;
  std::function<bool()> stop;  ///< polled; true ends the experiment; may be empty
};

struct ExperimentType;

/// Inputs of one experiment.
struct ExperimentContext {
  const ExperimentType& type;
  const Scenario& scenario;
  const ExperimentOptions& options;
  gpu::Device& device;
  std::function<void(double, const std::string&)> progress;  ///< receives the completed fraction and the next step
};

/// The input of an experiment.
enum class ExperimentSource : std::uint8_t {
  scenario,      ///< a scenario file
  measurements,  ///< evaluates `ExperimentOptions::data`: no scenario, no trials, no device
  model          ///< a model of its own: no scenario, no device
};

struct ExperimentType {
  std::string_view name;
  std::string_view scenario;  ///< stem of its scenario file; empty: its name
  std::string_view summary;   ///< one line for help
  ExperimentSource source = ExperimentSource::scenario;
  bool fixed_trials = false;   ///< ignores `ExperimentOptions::trials`
  Plant plant = Plant::ideal;  ///< default for the scenario and the user
  /// Text for the report: reasons for deviations from the thesis, or the findings.
  std::string_view reasons;
  /// Runs the experiment.
  /// @return names of the files written to the output folder
  std::vector<std::string> (*run)(const ExperimentContext& context);
};

std::span<const ExperimentType* const> experiments();
/// Returns null for an unknown name.
const ExperimentType* find_experiment(std::string_view name);

/// Reads the scenario, runs the experiment and writes its files. With several ranks, the first one writes the files,
/// and each writes its parts of the recordings.
/// @return the files written
/// @throws base::InputError for an invalid scenario or a folder that cannot be written
/// @throws Interrupted if `options.stop` returns true; the recordings of complete trials remain, and no other file is
/// written
std::vector<std::string> run_experiment(const ExperimentType& type, const ExperimentOptions& options,
                                        gpu::Device& device,
                                        const std::function<void(double, const std::string&)>& progress);

// --- For experiments -------------------------------------------------------------------------------------------------

/// Runs all trials in sequence, each with the output folder `trial-<k>/`.
std::vector<Trial> run_trials(const ExperimentContext& context, const TrialOptions& options);
/// Returns whether this process writes the report: only the first of several ranks does.
bool reports(const ExperimentContext& context);
/// Returns options of a trial without a recording.
TrialOptions trial_options(const ExperimentContext& context);
/// Returns the path of a file in the output folder.
std::string in_folder(const ExperimentContext& context, const std::string& name);
/// Creates the output folder given with -o, and its parents if missing.
/// @throws base::InputError with the path on failure
void make_folder(const std::string& path);
/// @throws base::InputError with the path on failure
void write_text(const std::string& path, const std::string& text);
/// Returns "3 trials", "1 trial".
std::string counted(std::uint64_t count, std::string_view one);
/// Returns the setup for reports: "plant `thesis`, seeds 1 to 3, link ...".
std::string setup_of(const ExperimentContext& context, const Disturbance& disturbance);

}  // namespace sf::scenarios
