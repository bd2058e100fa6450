// libFuzzer target: any bytes as a height map.

#include <cmath>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/terrain.h"

using namespace sf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const world::HeightMap map =
        world::decode_height_map("fuzz.png", std::string(reinterpret_cast<const char*>(data), size), -2.0, 3.0);
    require(map.columns >= 2 && map.rows >= 2 && map.heights.size() == std::size_t{map.columns} * map.rows);
    for (const float height : map.heights) require(height >= -2.0f && height <= 3.0f);
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with("fuzz.png"));
  }
  return 0;
}
