#pragma once
// Text of figures, rendered by VTK. VTK loads slowly, so it is in a plug-in (text_renderer.cpp,
// `sensorfarm_text_renderer.so`) that is loaded with the first figure.

#include <cstdint>
#include <string>
#include <vector>

namespace sf::viz {

/// Rendered text: coverage of each pixel.
struct GlyphBitmap {
  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;  ///< row by row, the top row first; 255: full coverage
};

struct TextRun {
  std::string text;  ///< UTF-8, one line, not empty
  int size = 18;     ///< [px] em height, > 0
  bool bold = false;
  bool upwards = false;   ///< turned by 90 degrees, read from below
  std::string font_file;  ///< empty: the built-in face
};

/// Does not throw. One thread at a time: VTK's font cache is shared.
struct TextRenderer {
  /// @return false when the text cannot be rendered.
  bool (*render)(const TextRun& letters, GlyphBitmap& out);
};

/// The name of the plug-in's only symbol: `extern "C" const TextRenderer sensorfarm_text_renderer`.
inline constexpr const char* kTextRendererSymbol = "sensorfarm_text_renderer";

/// Loads the plug-in, once, from the folder of the running program or the system's library path.
/// @throws base::InputError naming the file when it cannot be loaded.
const TextRenderer& text_renderer();

}  // namespace sf::viz
