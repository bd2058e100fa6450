#include "scenarios/experiment.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace sf::scenarios {

// Every experiment, in the order of help.
extern const ExperimentKind lane_edge_p_experiment;
extern const ExperimentKind lane_edge_pi_experiment;
extern const ExperimentKind magnet_p_experiment;
extern const ExperimentKind magnet_pi_experiment;
extern const ExperimentKind mapping_experiment;
extern const ExperimentKind minimagic_experiment;
extern const ExperimentKind simville_experiment;
extern const ExperimentKind simville_merge_experiment;
extern const ExperimentKind sweeps_experiment;

std::span<const ExperimentKind* const> experiments() {
  static constexpr const ExperimentKind* kKinds[] = {
      &lane_edge_p_experiment,    &lane_edge_pi_experiment, &magnet_p_experiment,
      &magnet_pi_experiment,      &mapping_experiment,      &simville_experiment,
      &simville_merge_experiment, &minimagic_experiment,    &sweeps_experiment};
  return kKinds;
}

const ExperimentKind* find_experiment(std::string_view name) {
  for (const ExperimentKind* kind : experiments())
    if (kind->name == name) return kind;
  return nullptr;
}

std::vector<std::string> run_experiment(const ExperimentKind& kind, const ExperimentOptions& options,
                                        gpu::Device& device,
                                        const std::function<void(double, const std::string&)>& progress) {
  Scenario scenario =
      read_scenario((std::filesystem::path(options.folder) / (std::string(kind.name) + ".toml")).string());
  scenario.plant = options.plant ? *options.plant : scenario.plant ? *scenario.plant : kind.plant;
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error)
    throw base::InputError(options.out, 0, "cannot be made a folder: " + error.message() + "; name another with -o");
  return kind.run({scenario, options, device, progress});
}

std::vector<Trial> run_trials(const Bench& bench, const TrialOptions& options) {
  std::vector<Trial> trials;
  for (std::uint32_t k = 0; k < bench.options.trials; ++k) {
    if (bench.progress) bench.progress(static_cast<double>(k) / bench.options.trials, fmt::format("trial {}", k + 1));
    Scenario scenario = bench.scenario;
    scenario.seed = bench.options.seed + k;
    TrialOptions own = options;
    own.threads = bench.options.threads;
    own.record = in_folder(bench, fmt::format("trial-{}", k + 1));
    trials.push_back(run_trial(scenario, disturbed_world(scenario, options.disturbance), bench.device, own));
  }
  return trials;
}

std::string in_folder(const Bench& bench, const std::string& name) {
  return (std::filesystem::path(bench.options.out) / name).string();
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) throw base::InputError(path, 0, "cannot be written; name a folder that can be");
}

std::string setup_of(const Bench& bench, const Disturbance& d) {
  const netio::LinkPlan& link = bench.scenario.actor.link;
  const std::uint64_t last = bench.options.seed + bench.options.trials - 1;
  return fmt::format(
      "Plant `{}`, seeds {} to {}, at most {:g} s simulated. Readings come {:g} to {:g} s late, {:g} % of them never. "
      "The start is off by {:g} mm along and across and by {:.2g} degrees; noise (where the world has none): {:g} mm "
      "on each ray of a lane edge sensor, {:g} Gauss on each component of a magnetometer, {:g} mm on each beam of a "
      "laser (all standard deviations).",
      name_of(bench.scenario.plant.value_or(Plant::ideal)), bench.options.seed, last, bench.scenario.duration,
      link.delay, link.delay + link.jitter, 100.0 * link.loss, 1e3 * d.place, d.heading * 180.0 / M_PI,
      1e3 * d.edge_noise, d.field_noise, 1e3 * d.scan_noise);
}

}  // namespace sf::scenarios
