#pragma once
// Paints drawings with Cairo, a library for PNG's pixels, PDF and text. It is in a plug-in (cairo.cpp,
// `sensorfarm_cairo.so`) that is loaded with the first figure. Needs neither a display nor OpenGL.

#include <cstdint>
#include <string>
#include <vector>

#include "viz/drawing.h"

namespace sf::viz {

/// The functions do not throw. One thread at a time: the fonts are shared.
struct DrawingBackend {
  /// [px] advance of a text along its baseline.
  double (*text_width)(const Lettering& text);
  /// Red, green and blue of each pixel, row by row, the top row first, `scale` pixels per layout pixel; the picture's
  /// sides are rounded up. @return false when there is no memory for it.
  bool (*pixels)(const Drawing& drawing, double scale, std::vector<std::uint8_t>& rgb);
  /// The bytes of a PDF file with embedded fonts. @param scale of its size on paper: 1 is 180 layout pixels per inch.
  /// @return false when it cannot be made.
  bool (*pdf)(const Drawing& drawing, double scale, std::string& bytes);
};

/// The name of the plug-in's only symbol: `extern "C" const DrawingBackend sensorfarm_cairo`.
inline constexpr const char* kDrawingBackendSymbol = "sensorfarm_cairo";

/// Loads the plug-in, once, from the folder of the running program or the system's library path.
/// @throws base::InputError naming the file when it cannot be loaded.
const DrawingBackend& drawing_backend();

}  // namespace sf::viz
