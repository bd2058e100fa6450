// libFuzzer target: any bytes as a PNG or PGM picture, traced as a floor plan.

#include <cstdint>
#include <string>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/picture.h"
#include "world/stage/model_shape.h"

using namespace sf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kMost = 1u << 20;  // pixels: larger ones are sound, and slow
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  try {
    const world::Picture picture = world::decode_picture("fuzz.png", bytes, world::Channel::mean);
    require(picture.value.size() == std::size_t{picture.width} * picture.height);
    require(picture.opaque.empty() || picture.opaque.size() == picture.value.size());
    if (picture.value.size() > kMost) return 0;
    world::Bitmap grid{picture.width, picture.height, picture.value};
    for (std::uint8_t& cell : grid.solid) cell = cell <= 127 ? 1 : 0;
    const auto traced = world::trace_bitmap(std::move(grid), "fuzz.png");
    for (const world::BoundaryRun& run : traced->runs) require(run.a.i <= picture.width && run.b.j <= picture.height);
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with("fuzz.png"));
  }
  return 0;
}
