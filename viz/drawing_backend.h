#pragma once
// Paints drawings with Cairo, which renders PNG pixels, PDF and text. Cairo is in a plug-in (cairo.cpp,
// `sensorfarm_cairo.so`) that is loaded with the first figure. Needs neither a display nor OpenGL.

#include <cstdint>
#include <string>
#include <vector>

#include "viz/drawing.h"

namespace sf::viz {

/// The functions do not throw. They must be called by one thread at a time, since the fonts are shared.
struct DrawingBackend {
  /// Returns the advance [px] of a text along its baseline.
  double (*text_width)(const Lettering& text);
  /// Renders red, green and blue of each pixel, row by row, the top row first, with `scale` pixels per layout pixel;
  /// the picture's sides are rounded up. @return false if there is not enough memory.
  bool (*pixels)(const Drawing& drawing, double scale, std::vector<std::uint8_t>& rgb);
  /// Creates a PDF file with embedded fonts. @param scale of its size on paper: 1 is 180 layout pixels per inch.
  /// @return false on failure.
  bool (*pdf)(const Drawing& drawing, double scale, std::string& bytes);
};

/// The only symbol of the plug-in: `extern "C" const DrawingBackend sensorfarm_cairo`.
inline constexpr const char* kDrawingBackendSymbol = "sensorfarm_cairo";

/// Loads the plug-in once, from the folder of the running program or the system's library path.
/// @throws base::InputError naming the file if it cannot be loaded.
const DrawingBackend& drawing_backend();

}  // namespace sf::viz
