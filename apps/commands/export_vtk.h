#pragma once
// A recording as files of VTK, which ParaView opens.

#include <string>
#include <vector>

#include "apps/options/recording_part.h"

namespace sf::apps {

/// Writes `walls.vtp`, `roads.vtp`, `trajectories.vtp`, the series `robots.pvd` and `scans.pvd`, `occupancy.vti` and
/// `field.vti` into `options.out`, each where the recording's world has any.
/// @return the files written, of a series the `.pvd` file
std::vector<std::string> write_vtk(const RecordingPart& part, const ExportOptions& options);

}  // namespace sf::apps
