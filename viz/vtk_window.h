#pragma once
// VTK's interactive window for a recorded run. VTK is in a plug-in (viz/vtk/plugin.h) that is loaded when a window is
// opened. Needs a display and OpenGL.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "viz/picture_file.h"
#include "viz/vtk_files.h"

namespace sf::viz {

/// The moving objects of a scene.
struct Frame3d {
  PolyData bodies, beams, lights, clouds;
};

struct Scene3d {
  std::string title;
  PolyData walls, roads;
  std::optional<GridData> field;              ///< cell arrays `magnitude` [T] and `in_plane` (x, y, 0) [T]
  std::vector<double> times;                  ///< [s] of each frame, ascending, at least one
  std::function<Frame3d(std::size_t)> frame;  ///< of an index into `times`
  std::size_t first = 0;                      ///< initial index into `times`
  std::function<void()> opened;               ///< called once the window has opened for a user
  std::function<bool()> stop;                 ///< polled; true closes the window
  int width = 1280, height = 800;             ///< [px] of the window
};

/// Shows the scene until its window is closed or `stop` returns true. Space plays and pauses, the arrow keys step, the
/// slider sets the time, q closes.
/// @param picture not null: receives the window's pixels once, and the function returns without waiting for a user
/// @throws base::InputError without a display
void show_window(const Scene3d& scene, PixelImage* picture = nullptr);

}  // namespace sf::viz
