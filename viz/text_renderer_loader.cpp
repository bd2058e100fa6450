#include "base/plugin.h"
#include "viz/text_renderer.h"

namespace sf::viz {

const TextRenderer& text_renderer() {
  static const auto* const loaded =
      static_cast<const TextRenderer*>(base::load_plugin(kTextRendererSymbol, "nothing can be drawn", "VTK 9.1"));
  return *loaded;
}

}  // namespace sf::viz
