#include "viz/drawing_backend.h"

#include "base/plugin.h"

namespace sf::viz {

const DrawingBackend& drawing_backend() {
  static const auto* const loaded = static_cast<const DrawingBackend*>(base::load_plugin(
      kDrawingBackendSymbol, "nothing can be drawn", "Cairo and a font (Debian: libcairo2 fonts-dejavu-core)"));
  return *loaded;
}

}  // namespace sf::viz
