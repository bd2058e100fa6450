#pragma once
// What VTK does for a canvas: text, and PNG files. VTK's libraries take longer to load than a robot takes to look, so
// they belong to a module (pen.cpp, `sensorfarm_pen.so`) that is loaded when something is first drawn.

#include <cstdint>
#include <string>
#include <vector>

namespace sf::viz {

/// Letters to be printed: how far each pixel is covered.
struct Stencil {
  int width = 0, height = 0;
  std::vector<std::uint8_t> covered;  ///< row by row, the top row first; 255: wholly
};

struct Letters {
  std::string text;  ///< UTF-8, one line, not empty
  int size = 18;     ///< [px] em height, > 0
  bool bold = false;
  bool upwards = false;   ///< turned by 90 degrees, read from below
  std::string font_file;  ///< empty: the built-in face
};

/// Does not throw. One thread at a time: VTK's font cache is shared.
struct Pen {
  /// @return false when the letters cannot be rendered.
  bool (*print)(const Letters& letters, Stencil& out);
  /// @param rgb three bytes a pixel, row by row, the top row first. @return false when there is no picture.
  bool (*encode_png)(const std::uint8_t* rgb, int width, int height, std::vector<std::uint8_t>& out);
};

/// The name of the module's one symbol: `extern "C" const Pen sensorfarm_pen`.
inline constexpr const char* kPenSymbol = "sensorfarm_pen";

/// Loads the module, once, from the folder of the running program or wherever the system finds libraries.
/// @throws base::InputError naming the file when it cannot be loaded.
const Pen& pen();

}  // namespace sf::viz
