// `export`: writes a recording as tables or geometry for other programs.

#include <fmt/format.h>

#include <cmath>

#include "apps/commands/commands.h"
#include "apps/commands/export_vtk.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/recording_csv.h"
#include "apps/reports/text.h"
#include "scenarios/experiment.h"

namespace sf::apps {

namespace {

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
  const std::vector<std::string> files = options.vtk ? write_vtk(part, options) : write_csv(part, options.out);
  for (const std::string& file : files) print_message("wrote {}", file);
  if (!options.vtk && part.recording.readings.empty())
    print_message("no readings: the run was not recorded with --record-readings, or these robots have no sensor");
  return 0;
}

}  // namespace sf::apps
