#pragma once
// The interface of the VTK plug-in, `sensorfarm_vtk.so`, which is loaded when a file is first written or a window is
// opened. The functions do not throw.

#include <string>

#include "viz/vtk_files.h"
#include "viz/vtk_window.h"

namespace sf::viz {

struct VtkPlugin {
  /// @return false if the file cannot be written
  bool (*write_poly_data)(const PolyData& data, const std::string& path);
  bool (*write_grid)(const GridData& data, const std::string& path);
  /// @return the missing prerequisite for a window; empty on success
  std::string (*show_window)(const Scene3d& scene, PixelImage* picture);
};

/// The only symbol of the plug-in: `extern "C" const VtkPlugin sensorfarm_vtk`.
inline constexpr const char* kVtkSymbol = "sensorfarm_vtk";

/// Loads the plug-in once. @throws base::InputError naming the file if it cannot be loaded
const VtkPlugin& vtk_plugin();

// Within the plug-in.
bool poly_data_file(const PolyData& data, const std::string& path);
bool grid_file(const GridData& grid, const std::string& path);
std::string show_scene(const Scene3d& scene, PixelImage* picture);

}  // namespace sf::viz
