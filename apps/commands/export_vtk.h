#pragma once
// Exports a recording as VTK files, which ParaView opens.

#include <string>
#include <vector>

#include "apps/options/recording_part.h"

namespace sf::apps {

/// Writes `walls.vtp`, `roads.vtp`, `trajectories.vtp`, the series `robots.pvd` and `scans.pvd`, `occupancy.vti` and
/// `field.vti` into `options.out`, as far as the recording and its world have such data.
/// @return the files written; for a series only the `.pvd` file
std::vector<std::string> write_vtk(const RecordingPart& part, const ExportOptions& options);

}  // namespace sf::apps
