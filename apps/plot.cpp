// `plot`: pictures from a recording, later and elsewhere. Scans are computed again from the recorded poses and world.

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "apps/commands.h"
#include "apps/plot_maps.h"
#include "apps/plot_readings.h"
#include "apps/progress_line.h"
#include "apps/report.h"
#include "apps/stop_signals.h"
#include "apps/text.h"
#include "base/error.h"
#include "base/time.h"
#include "farm/farm.h"
#include "record/recording.h"
#include "scenarios/experiment.h"
#include "sensors/laser.h"
#include "viz/occupancy_figure.h"
#include "viz/scan_map.h"
#include "viz/trajectory_figure.h"

namespace sf::apps {

namespace {

std::vector<viz::Track> tracks_of(const record::Recording& recording, const world::World& world) {
  std::vector<viz::Track> tracks;
  for (std::size_t m = 0; m < recording.states.size(); ++m) {
    if (world.movers[m].is_tag) continue;
    viz::Track track{world.movers[m].name, std::nullopt, {}, {}, 1e-9 * static_cast<double>(recording.end_time)};
    for (const record::StateSample& s : recording.states[m]) {
      if (base::is_absent(s.X_WM)) continue;
      track.poses.push_back(s.X_WM);
      track.contacts.push_back(s.contact);
    }
    tracks.push_back(std::move(track));
  }
  return tracks;
}

/// Pictures are written whole: a stop is heeded between two.
/// @throws base::InputError when one was asked for.
void go_on() {
  if (stop_requested())
    throw base::InputError("interrupted: the pictures that were written are whole, others are not there");
}

/// Computes every laser's scan once a simulated second from where its robot was.
void map_scans(const record::Recording& recording, const world::World& world, gpu::Device& device, viz::ScanMap& map) {
  farm::FarmOptions quiet;
  quiet.noise = false;
  farm::Farm farm(world, device, quiet);
  const auto every = static_cast<std::size_t>(std::max(1.0, std::round(1.0 / recording.info.interval)));
  std::vector<base::Report> reports;
  const std::size_t ticks = recording.states.empty() ? 0 : recording.states[0].size();
  Progress progress("mapping");
  for (std::size_t t = 0; t < ticks; t += every) {
    reports.clear();
    for (std::uint32_t m = 0; m < recording.states.size(); ++m) {
      const record::StateSample& s = recording.states[m][t];
      farm.set_absent(m, base::is_absent(s.X_WM));
      farm.subscribe(m, 1u << sensors::kLaser);
      reports.push_back({m, s.time, s.X_WM, s.velocity});
    }
    // Slow sensors look too: each tick is as far from the last as their period.
    const auto now = static_cast<std::int64_t>(t + 1) * 1000 * base::kSecond;
    for (const base::ReadingBlock& reading : farm.tick(now, reports)) map.add(world, reading);
    progress.show(static_cast<double>(t) / static_cast<double>(ticks));
    go_on();
  }
}

}  // namespace

int plot(const PlotOptions& options) {
  const record::Recording recording = record::open_recording(options.recording);
  print_damage(recording);
  const world::World world = world::from_snapshot(recording.info.snapshot);
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::path(recording.file).parent_path() : std::filesystem::path(options.out);
  scenarios::make_folder(folder.string());

  install_stop_handlers();
  const std::string trajectories = (folder / "trajectories.png").string();
  viz::draw_trajectories(world, tracks_of(recording, world), trajectories);
  print_message("wrote {}", trajectories);
  go_on();
  for (const std::string& file : draw_readings(recording, folder.string())) print_message("wrote {}", file);
  go_on();
  for (const std::string& file : draw_maps(recording, world, folder.string())) print_message("wrote {}", file);
  go_on();

  gpu::Device device(options.device);
  viz::ScanMap map(viz::grid_over(world.extent));
  map_scans(recording, world, device, map);
  const std::string occupancy = (folder / "occupancy.png").string();
  viz::draw_occupancy(world, map.states(), occupancy);
  print_message("wrote {}", occupancy);
  return 0;
}

}  // namespace sf::apps
