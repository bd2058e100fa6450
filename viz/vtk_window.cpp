#include "viz/vtk_window.h"

#include "base/error.h"
#include "viz/vtk/plugin.h"

namespace sf::viz {

void show_window(const Scene3d& scene, PixelImage* picture) {
  const std::string problem = vtk_plugin().show_window(scene, picture);
  if (!problem.empty()) throw base::InputError(problem);
}

}  // namespace sf::viz
