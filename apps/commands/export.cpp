// `export`: writes a recording as tables or geometry for other programs.

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "apps/commands/cloud_files.h"
#include "apps/commands/cloud_replay.h"
#include "apps/commands/commands.h"
#include "apps/commands/field_grid.h"
#include "apps/commands/numbered_files.h"
#include "apps/commands/scan_replay.h"
#include "apps/options/open_device.h"
#include "apps/options/recording_part.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/recording_csv.h"
#include "apps/reports/text.h"
#include "base/elementary.h"
#include "base/error.h"
#include "gpu/device.h"
#include "scenarios/experiment.h"
#include "scenarios/recorded_states.h"
#include "viz/scan_map.h"
#include "viz/vtk_files.h"
#include "viz/world_geometry.h"

namespace sf::apps {

namespace {

std::vector<std::vector<viz::MotionSample>> motions_of(const RecordingPart& part, const world::World& world) {
  std::vector<std::vector<viz::MotionSample>> motions(part.recording.states.size());
  for (std::size_t m = 0; m < motions.size(); ++m) {
    if (part.chosen[m] == 0 || world.movers[m].is_tag) continue;
    for (const record::StateSample& s : part.recording.states[m])
      motions[m].push_back(
          {1e-9 * static_cast<double>(s.time), s.X_WM, base::hypot(s.velocity.forward, s.velocity.left), s.contact});
  }
  return motions;
}

double time_at(const RecordingPart& part, std::size_t tick) {
  for (const auto& states : part.recording.states)
    if (tick < states.size()) return 1e-9 * static_cast<double>(states[tick].time);
  return 0.0;
}

/// A file series over time.
class FileSeries {
 public:
  FileSeries(std::string folder, std::string name) : folder_(std::move(folder)), name_(std::move(name)) {
    begin_numbered_files(folder_ + "/" + name_, name_ + "_", ".vtp");
  }
  void add(double time, const viz::PolyData& data) {
    files_.push_back({time, fmt::format("{0}/{0}_{1:06}.vtp", name_, files_.size())});
    viz::write_poly_data(data, folder_ + "/" + files_.back().file);
  }
  std::string close() const {
    const std::string path = folder_ + "/" + name_ + ".pvd";
    viz::write_file_series(files_, path);
    return path;
  }

 private:
  std::string folder_, name_;
  std::vector<viz::SeriesFile> files_;
};

/// Cell states as in the robots' occupancy maps: 0 unexplored, 1 occupied, 2 free.
viz::GridData grid_of(const maps::OccupancyGrid& map) {
  const maps::GridGeometry& g = map.geometry;
  const auto columns = static_cast<int>(maps::columns(g)), rows = static_cast<int>(maps::rows(g));
  viz::GridData grid{g.left, g.top - g.cell * rows, 0.0, g.cell, g.cell, columns, rows, {{"state", 1, {}}}};
  for (std::int64_t row = rows - 1; row >= 0; --row)
    for (std::int64_t column = 0; column < columns; ++column)
      grid.cell_data[0].values.push_back(static_cast<double>(map.at({column, row})));
  return grid;
}

std::vector<std::string> write_scans(const RecordingPart& part, world::World& world, gpu::Device& device,
                                     const ExportOptions& options) {
  ScanReplay replay(part, world, device);
  viz::ScanMap map(viz::grid_over(world.extent));
  FileSeries series(options.out, "scans");
  const std::vector<std::size_t> ticks = ticks_apart(part, options.every);
  Progress progress("scanning");
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    viz::ScanGeometry scans(false);
    for (const base::ReadingBlock& scan : replay.scans_at(ticks[i])) {
      scans.add(replay.laser(scan), replay.X_MS(scan), scan);
      map.add(world, replay.laser(scan), replay.X_MS(scan), scan);
    }
    series.add(time_at(part, ticks[i]), scans.data());
    progress.show(static_cast<double>(i) / static_cast<double>(ticks.size()));
    heed_stop();
  }
  const std::string occupancy = options.out + "/occupancy.vti";
  viz::write_grid(grid_of(map.states()), occupancy);
  return {series.close(), occupancy};
}

/// Writes the newest recorded scans of all chosen lidars over time.
std::vector<std::string> write_cloud_series(const RecordingPart& part, const world::World& world,
                                            const ExportOptions& options) {
  const std::unique_ptr<CloudReplay> replay = clouds_to_draw(part, world);
  if (!replay) return {};
  FileSeries series(options.out, "clouds");
  Progress progress("writing clouds");
  const std::vector<std::size_t> ticks = ticks_apart(part, options.every);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    series.add(time_at(part, ticks[i]), echoes_of(replay->at(ticks[i], true)));
    progress.show(static_cast<double>(i) / static_cast<double>(ticks.size()));
    heed_stop();
  }
  return {series.close()};
}

/// Writes `walls.vtp`, `roads.vtp`, `trajectories.vtp`, the series `robots.pvd`, `clouds.pvd` and `scans.pvd`,
/// `occupancy.vti` and `field.vti` into `options.out`, as far as the recording and its world have such data.
/// @return the files written; for a series only the `.pvd` file
std::vector<std::string> write_vtk(const RecordingPart& part, const ExportOptions& options) {
  world::World world = scenarios::recorded_world(part.recording);
  std::vector<std::string> files;
  const auto write = [&](const viz::PolyData& data, const char* name) {
    if (data.points.empty()) return;
    files.push_back(options.out + "/" + name);
    viz::write_poly_data(data, files.back());
    heed_stop();
  };
  write(viz::walls_geometry(world), "walls.vtp");
  write(viz::roads_geometry(world), "roads.vtp");
  write(viz::trajectories_geometry(world, motions_of(part, world)), "trajectories.vtp");
  FileSeries robots(options.out, "robots");
  scenarios::RecordedShapes shapes(part.recording, world);
  for (const std::size_t tick : ticks_apart(part, options.every)) {
    shapes.go_to(part.recording.states.front()[tick].time);
    robots.add(time_at(part, tick), viz::bodies_geometry(world, poses_at(part, tick))), heed_stop();
  }
  files.push_back(robots.close());
  for (std::string& file : write_cloud_series(part, world, options)) files.push_back(std::move(file));
  if (!has_laser(part, world) && world.magnets.empty()) return files;

  gpu::Device device = open_device(options);
  shapes.go_to(0);  // the scans begin with the first tick
  if (has_laser(part, world))
    for (std::string& file : write_scans(part, world, device, options)) files.push_back(std::move(file));
  if (const auto field = field_grid(world, device, options.height)) {
    files.push_back(options.out + "/field.vti");
    viz::write_grid(*field, files.back());
  }
  return files;
}

std::vector<std::string> write_csv(const RecordingPart& part, const std::string& folder) {
  std::vector<std::string> files{write_trajectories_csv(part, folder)};
  if (!part.recording.lights.empty()) files.push_back(write_lights_csv(part, folder));
  for (std::string& file : write_readings_csv(part, folder)) files.push_back(std::move(file));
  return files;
}

}  // namespace

int export_recording(const ExportOptions& options) {
  install_stop_handlers();
  const RecordingPart part = open_part(options.recording, options);
  scenarios::make_folder(options.out);
  const bool clouds = options.clouds != CloudFormat::none;
  const std::vector<std::string> files = options.vtk ? write_vtk(part, options)
                                         : clouds    ? write_clouds(part, options.out, options.clouds)
                                                     : write_csv(part, options.out);
  for (const std::string& file : files) print_message("wrote {}", file);
  if (clouds && files.empty())
    print_message("no clouds: the run was recorded without --record-readings, or these robots have no lidars");
  if (!options.vtk && !clouds && part.recording.readings.empty())
    print_message("no readings: the run was recorded without --record-readings, or these robots have no sensors");
  return 0;
}

}  // namespace sf::apps
