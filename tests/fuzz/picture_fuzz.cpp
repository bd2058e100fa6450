// libFuzzer target: any bytes as a picture, traced as a floor plan. JPEG, BMP and GIF need the plug-in, which is
// missing here: only their headers are read.

#include <cstdint>
#include <string>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/picture.h"
#include "world/stage/model_picture.h"

using namespace sf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMost = 1u << 20;  // pixels: larger pictures are valid, but slow
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    std::size_t rows = 0, width = 0;
    world::Bitmap grid = world::decode_bitmap("fuzz.png", bytes, [&](const world::PixelRow& row, std::uint8_t* solid) {
      ++rows;
      width = row.rgba.size() / 4;
      for (std::size_t i = 0; i < row.rgba.size(); i += 4) *solid++ = row.rgba[i] <= 127 ? 1 : 0;
    });
    require(rows == grid.height && width == grid.width && grid.solid.size() == rows * width);
    if (grid.solid.size() > kMost) return 0;
    const auto traced = world::trace_bitmap(std::move(grid), "fuzz.png");
    for (const world::BoundaryRun& run : traced.runs)
      require(run.a.i <= width && run.b.j <= rows && run.a.i >= traced.solid.low.i && run.a.j <= traced.solid.high.j);
    require(traced.solid.low.i < traced.solid.high.i && traced.solid.low.j < traced.solid.high.j);
  } catch (const base::InputError& error) {
    const std::string_view what = error.what();
    require(what.starts_with("fuzz.png") || what.starts_with(world::kPicturesSymbol));
  }
  return 0;
}
