#pragma once
// The functions of the plug-in with VTK, `sensorfarm_vtk.so`, which is loaded when a file is first written or a window
// is opened. They do not throw.

#include <string>

#include "viz/vtk_files.h"
#include "viz/vtk_window.h"

namespace sf::viz {

struct VtkPlugin {
  /// @return false when the file cannot be written
  bool (*write_poly_data)(const PolyData& data, const std::string& path);
  bool (*write_grid)(const GridData& data, const std::string& path);
  /// @return what is missing for a window; empty when all went well
  std::string (*show_window)(const Scene3d& scene, PixelImage* picture);
};

/// The name of the plug-in's only symbol: `extern "C" const VtkPlugin sensorfarm_vtk`.
inline constexpr const char* kVtkSymbol = "sensorfarm_vtk";

/// Loads the plug-in, once. @throws base::InputError naming the file when it cannot be loaded
const VtkPlugin& vtk_plugin();

// Within the plug-in.
bool poly_data_file(const PolyData& data, const std::string& path);
bool grid_file(const GridData& grid, const std::string& path);
std::string show_scene(const Scene3d& scene, PixelImage* picture);

}  // namespace sf::viz
