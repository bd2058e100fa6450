// `plot`: draws pictures from a recording. Scans are recomputed from the recorded poses and world.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "apps/commands/commands.h"
#include "apps/commands/plot_allan.h"
#include "apps/commands/plot_maps.h"
#include "apps/commands/plot_readings.h"
#include "apps/commands/recorded_video.h"
#include "apps/commands/scan_replay.h"
#include "apps/options/open_device.h"
#include "apps/options/recording_part.h"
#include "apps/options/robot_names.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/recording_csv.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/files.h"
#include "scenarios/experiment.h"
#include "scenarios/recorded_states.h"
#include "scenarios/sweep_plots.h"
#include "viz/lights_figure.h"
#include "viz/occupancy_figure.h"
#include "viz/scan_map.h"
#include "viz/trajectory_figure.h"

namespace sf::apps {

namespace {

constexpr std::size_t kLargestTable = 1u << 30;  // bytes of jobs.csv

std::vector<viz::Track> tracks_of(const RecordingPart& part, const world::World& world) {
  std::vector<viz::Track> tracks;
  for (std::size_t m = 0; m < part.recording.states.size(); ++m) {
    if (world.movers[m].is_tag || part.chosen[m] == 0) continue;
    viz::Track track{world.movers[m].name, std::nullopt, {}, {}, part.seconds};
    for (const record::StateSample& s : part.recording.states[m]) {
      if (base::is_absent(s.X_WM)) continue;
      track.poses.push_back(s.X_WM);
      track.contacts.push_back(s.contact);
    }
    tracks.push_back(std::move(track));
  }
  return tracks;
}

/// Merges successive equal states of each light into spans.
std::vector<viz::LightRow> light_rows(const record::Recording& recording, const world::World& world) {
  std::vector<viz::LightRow> rows;
  for (const world::Light& light : world.lights) rows.push_back({light.name, {}});
  for (std::size_t t = 0; t < recording.lights.size(); ++t) {
    const record::LightsSample& sample = recording.lights[t];
    const double time = 1e-9 * static_cast<double>(sample.time);
    const double end = t + 1 < recording.lights.size() ? 1e-9 * static_cast<double>(recording.lights[t + 1].time)
                                                       : time + recording.info.interval;
    for (std::size_t k = 0; k < std::min(rows.size(), sample.lights.size()); ++k) {
      const auto state = static_cast<world::LightState>(sample.lights[k].state);
      std::vector<viz::LightSpan>& spans = rows[k].spans;
      if (!spans.empty() && spans.back().state == state)
        spans.back().to = end;
      else
        spans.push_back({time, end, state});
    }
  }
  return rows;
}

/// Computes the scan of every chosen laser once per simulated second, at the recorded pose of its robot.
void map_scans(const RecordingPart& part, world::World& world, gpu::Device& device, viz::ScanMap& map) {
  ScanReplay replay(part, world, device);
  const std::vector<std::size_t> ticks = ticks_apart(part, 1.0);
  Progress progress("mapping");
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    for (const base::ReadingBlock& scan : replay.scans_at(ticks[i]))
      map.add(world, replay.laser(scan), replay.X_MS(scan), scan);
    progress.show(static_cast<double>(i) / static_cast<double>(ticks.size()));
    heed_stop();
  }
}

/// Prints the name of each file as soon as it is written.
struct Written {
  void operator()(const std::string& file) const {
    print_message("wrote {}", file);
    heed_stop();
  }
};

/// @throws base::InputError if a robot that is not drawn is to be labelled
viz::TrackLabels labels_of(const RecordingPart& part, const PlotOptions& options,
                           const std::vector<viz::Track>& tracks) {
  if (options.labels == std::vector<std::string>{"all"}) return {.all = true, .names = {}};
  std::vector<std::string_view> names;
  for (const viz::Track& track : tracks) names.push_back(track.name);
  const std::vector<std::string> labels = robot_names(options.labels, names);
  for (const std::string& label : labels)
    if (std::find(names.begin(), names.end(), label) == names.end())
      throw base::InputError(part.recording.file, 0,
                             fmt::format("--label: no robot '{}' is drawn; drawn are {}", label, list_names(names)));
  return {.all = false, .names = labels};
}

void draw_paths(const RecordingPart& part, const world::World& world, const PlotOptions& options,
                const std::string& folder) {
  const std::string trajectories = folder + "/trajectories." + options.format;
  const std::vector<viz::Track> tracks = tracks_of(part, world);
  const std::size_t left_out =
      viz::draw_trajectories(world, tracks, trajectories, "robot", options.page, labels_of(part, options, tracks));
  Written{}(trajectories);
  if (tracks.size() > viz::kLabelledTracks && options.labels.empty())
    print_message("{} robots have no label in it; label them with --label NAME,... or --label all", tracks.size());
  if (left_out > 0 && !options.labels.empty())
    print_message("{} labels are left out for lack of space; label fewer robots with --label NAME,..., or raise --size",
                  left_out);
  if (options.csv) Written{}(write_trajectories_csv(part, folder));
}

void draw_lights(const RecordingPart& part, const world::World& world, const PlotOptions& options,
                 const std::string& folder) {
  if (part.recording.lights.empty() || world.lights.empty()) return;
  const std::string lights = folder + "/lights." + options.format;
  const std::vector<viz::LightRow> rows = light_rows(part.recording, world);
  viz::draw_light_states(rows, fmt::format("{}: {}", part.recording.info.world, counted(rows.size(), "light")), lights,
                         options.page);
  Written{}(lights);
  if (options.csv) Written{}(write_lights_csv(part, folder));
}

void draw_allan(const viz::SeriesOptions& figure, const PlotOptions& options, const std::string& folder) {
  const std::string file = folder + "/allan.";
  viz::draw_series(figure, file + options.format, options.page);
  Written{}(file + options.format);
  if (!options.csv) return;
  scenarios::write_text(file + "csv", csv_of(figure));
  Written{}(file + "csv");
}

void draw_occupancy(const RecordingPart& part, world::World& world, const PlotOptions& options,
                    const std::string& folder) {
  if (!has_laser(part, world))
    return print_message("no occupancy.{}: none of these robots has a laser", options.format);
  gpu::Device device = open_device(options);
  viz::ScanMap map(viz::grid_over(world.extent));
  map_scans(part, world, device, map);
  const std::string occupancy = folder + "/occupancy." + options.format;
  viz::draw_occupancy(world, map.states(), occupancy, options.page);
  print_message("wrote {}", occupancy);
}

}  // namespace

namespace {

/// Plots the results of `sweep` in a folder.
int plot_sweep(const PlotOptions& options, const std::string& jobs) {
  if (!options.robots.empty() || !options.labels.empty() || !options.elements.empty() || options.curves ||
      options.allan || options.csv || !options.video.empty() || options.from > 0.0 || std::isfinite(options.to))
    throw base::InputError(
        options.recording, 0,
        "is the folder of a sweep; --robots, --label, --elements, --curves, --allan, --csv, --video, "
        "--from and --to apply to recordings");
  const std::string folder = options.out.empty() ? options.recording + "/plots" : options.out;
  const scenarios::SweepPlots plots = scenarios::draw_sweep(
      jobs, base::read_text(jobs, kLargestTable), folder, {options.over, options.x_axis, options.format, options.page});
  for (const std::string& note : plots.notes) print_message(note);
  for (const std::string& file : plots.files) Written{}(file);
  return 0;
}

/// Plots the Allan deviations of a table's columns.
int plot_table(const PlotOptions& options) {
  if (!options.allan) throw base::InputError(options.recording, 0, "is a table; expected --allan, or a recording");
  if (!options.robots.empty() || !options.video.empty() || options.from > 0.0 || std::isfinite(options.to))
    throw base::InputError(options.recording, 0, "is a table; --robots, --video, --from and --to apply to recordings");
  const std::filesystem::path beside = std::filesystem::path(options.recording).parent_path();
  const std::string folder = !options.out.empty() ? options.out : beside.empty() ? "." : beside.string();
  const std::string written = folder + "/allan.csv";
  if (options.csv && std::filesystem::exists(written) && std::filesystem::equivalent(written, options.recording))
    throw base::InputError(options.recording, 0, "would be overwritten by the figure's; name another folder by --out");
  const viz::SeriesOptions figure = allan_figure_of_table(options.recording);
  scenarios::make_folder(folder);
  draw_allan(figure, options, folder);
  return 0;
}

}  // namespace

int plot(const PlotOptions& options) {
  install_stop_handlers();
  if (const std::string jobs = options.recording + "/jobs.csv"; std::filesystem::is_regular_file(jobs))
    return plot_sweep(options, jobs);
  if (!options.over.empty() || options.x_axis != viz::AxisScale::automatic)
    throw base::InputError(options.recording, 0, "--over and --x-axis apply to the folder of a sweep");
  if (options.allan && (!options.elements.empty() || options.curves))
    throw base::InputError(options.recording, 0,
                           "--elements and --curves do not apply to --allan, which draws all axes");
  if (options.recording.ends_with(".csv")) return plot_table(options);
  RecordingPart part = open_part(options.recording, options);
  if (!options.video.empty()) return write_recorded_video(part, options, options.device), 0;
  world::World world = scenarios::recorded_world(part.recording);
  const std::string folder =
      options.out.empty() ? std::filesystem::path(part.recording.file).parent_path().string() : options.out;
  scenarios::make_folder(folder);

  if (options.allan) return draw_allan(allan_figure(part.recording, world), options, folder), 0;
  draw_paths(part, world, options, folder);
  for (const std::string& file : draw_readings(part.recording, world, options, folder)) Written{}(file);
  draw_lights(part, world, options, folder);
  for (const std::string& file : draw_maps(part.recording, world, options, folder)) Written{}(file);
  draw_occupancy(part, world, options, folder);
  return 0;
}

}  // namespace sf::apps
