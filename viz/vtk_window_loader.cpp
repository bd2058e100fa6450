#include "base/error.h"
#include "base/plugin.h"
#include "viz/vtk_window.h"

namespace sf::viz {

void show_window(const Scene3d& scene, PixelImage* picture) {
  static const auto* const loaded =
      static_cast<const WindowPlugin*>(base::load_plugin(kWindowSymbol, "no window can be opened", "VTK 9.1"));
  const std::string problem = loaded->show(scene, picture);
  if (!problem.empty()) throw base::InputError(problem);
}

}  // namespace sf::viz
