#include "scenarios/experiment.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "cluster/failure.h"
#include "scenarios/runner.h"

namespace sf::scenarios {

// All experiments, in the order of the help text.
extern const ExperimentType lane_edge_p_experiment;
extern const ExperimentType lane_edge_pi_experiment;
extern const ExperimentType magnet_p_experiment;
extern const ExperimentType magnet_pi_experiment;
extern const ExperimentType mapping_experiment;
extern const ExperimentType simville_experiment;
extern const ExperimentType simville_merge_experiment;
extern const ExperimentType minimagic_experiment;
extern const ExperimentType sweeps_experiment;
extern const ExperimentType late_states_experiment;
extern const ExperimentType accuracy_experiment;
extern const ExperimentType mrclam_experiment;
extern const ExperimentType sideslip_experiment;
extern const ExperimentType lane_sensor_experiment;
extern const ExperimentType lane_camera_experiment;
extern const ExperimentType monitor_experiment;
extern const ExperimentType links_experiment;
extern const ExperimentType follow_experiment;
extern const ExperimentType budget_experiment;
extern const ExperimentType location_experiment;
extern const ExperimentType tree_experiment;
extern const ExperimentType vesim_experiment;

std::span<const ExperimentType* const> experiments() {
  static constexpr const ExperimentType* kKinds[] = {
      &lane_edge_p_experiment, &lane_edge_pi_experiment, &magnet_p_experiment,       &magnet_pi_experiment,
      &mapping_experiment,     &simville_experiment,     &simville_merge_experiment, &minimagic_experiment,
      &sweeps_experiment,      &late_states_experiment,  &accuracy_experiment,       &mrclam_experiment,
      &sideslip_experiment,    &lane_sensor_experiment,  &lane_camera_experiment,    &monitor_experiment,
      &links_experiment,       &follow_experiment,       &budget_experiment,         &location_experiment,
      &tree_experiment,        &vesim_experiment};
  return kKinds;
}

const ExperimentType* find_experiment(std::string_view name) {
  for (const ExperimentType* type : experiments())
    if (type->name == name) return type;
  return nullptr;
}

std::vector<std::string> run_experiment(const ExperimentType& type, const ExperimentOptions& options,
                                        gpu::Device& device,
                                        const std::function<void(double, const std::string&)>& progress) {
  Scenario scenario;
  cluster::agree(options.ranks, [&] {
    if (type.source != ExperimentSource::scenario) return make_folder(options.out);
    scenario = read_scenario((std::filesystem::path(options.folder) /
                              (std::string(type.scenario.empty() ? type.name : type.scenario) + ".toml"))
                                 .string());
    scenario.plant = options.plant ? *options.plant : scenario.plant ? *scenario.plant : type.plant;
    make_folder(options.out);
    const std::vector<world::Warning> warnings = check_scenario(scenario);
    if (options.warn) options.warn(scenario.world, warnings);
  });
  return type.run({type, scenario, options, device, progress});
}

std::vector<Trial> run_trials(const ExperimentContext& context, const TrialOptions& options) {
  std::vector<Trial> trials;
  for (std::uint32_t k = 0; k < context.options.trials; ++k) {
    if (context.progress)
      context.progress(static_cast<double>(k) / context.options.trials, fmt::format("trial {}", k + 1));
    Scenario scenario = context.scenario;
    scenario.seed = context.options.seed + k;
    TrialOptions own = trial_options(context);
    own.maps = options.maps, own.supervisor = options.supervisor, own.disturbance = options.disturbance;
    own.record = in_folder(context, fmt::format("trial-{}", k + 1));
    try {
      trials.push_back(run_trial(scenario, disturbed_world(scenario, options.disturbance), context.device, own));
    } catch (const Interrupted&) {
      std::error_code ignored;
      std::filesystem::remove(std::filesystem::path(own.record) / recording_part_of(own.ranks, own.compression).file(),
                              ignored);
      std::filesystem::remove(own.record, ignored);  // fails and keeps the folder if it contains other files
      throw;
    }
  }
  return trials;
}

bool reports(const ExperimentContext& context) {
  return context.options.ranks == nullptr || context.options.ranks->rank() == 0;
}

TrialOptions trial_options(const ExperimentContext& context) {
  return {.compression = context.options.compression,
          .threads = context.options.threads,
          .stop = context.options.stop,
          .ranks = context.options.ranks};
}

std::string in_folder(const ExperimentContext& context, const std::string& name) {
  return (std::filesystem::path(context.options.out) / name).string();
}

void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw base::InputError(path, 0, "cannot be created as a folder: " + error.message() + "; name another");
}

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) throw base::InputError(path, 0, "cannot be written; name a writable folder");
}

std::string counted(std::uint64_t count, std::string_view one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : "s");
}

namespace {

std::string readings_of(const netio::LinkModel& link) {
  std::string text = "Readings arrive at once";
  if (link.jitter > 0.0)
    text = fmt::format("Readings arrive {:g} to {:g} s late", link.delay, link.delay + link.jitter);
  else if (link.delay > 0.0)
    text = fmt::format("Readings arrive {:g} s late", link.delay);
  return text +
         (link.loss > 0.0 ? fmt::format(", {:g} % of them are lost.", 100.0 * link.loss) : ", and none is lost.");
}

}  // namespace

std::string setup_of(const ExperimentContext& context, const Disturbance& d) {
  const std::uint64_t first = context.options.seed, last = first + context.options.trials - 1;
  return fmt::format(
      "Plant `{}`, {}, at most {:g} s simulated. {} "
      "The start is off by {:g} mm along and across and by {:.2g} degrees; noise (where the world has none): {:g} mm "
      "on each ray of a lane edge sensor, {:g} Gauss on each component of a magnetometer, {:g} mm on each beam of a "
      "laser (all standard deviations).",
      plant_name(context.scenario.plant.value_or(Plant::ideal)),
      first == last ? fmt::format("seed {}", first) : fmt::format("seeds {} to {}", first, last),
      context.scenario.duration, readings_of(context.scenario.actor.link), 1e3 * d.place, d.heading * 180.0 / M_PI,
      1e3 * d.edge_noise, d.field_noise, 1e3 * d.scan_noise);
}

}  // namespace sf::scenarios
