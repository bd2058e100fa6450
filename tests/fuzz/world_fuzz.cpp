// libFuzzer target: any bytes as a Stage world. An accepted world satisfies the rules of world.h and survives a
// recording. Includes and bitmaps are looked up in a folder that does not exist; other targets read those.

#include <cmath>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/stage/build_world.h"

namespace {

using namespace sf;

constexpr std::string_view kKeys[] = {"fov", "samples", "range_min", "range_max", "scount", "spose[]"};
constexpr std::string_view kBlockKeys[] = {"range", "view", "fov", "samples"};
constexpr world::SensorKeyword kWords[] = {{"laser", kKeys}, {"ranger", kKeys, kBlockKeys}};

void examine(const world::World& world) {
  for (const world::Segment& wall : world.walls)
    require((wall.a.x != wall.b.x || wall.a.y != wall.b.y) && wall.model < world.models.size());
  for (const world::LaneMarking& stripe : world.lane_markings) require(stripe.line.size() >= 2 && stripe.width > 0.0);
  for (const world::Mover& mover : world.movers) {
    require(mover.model < world.models.size() && std::isfinite(mover.radius) && mover.max_forward > 0.0);
    for (const world::Sensor& sensor : mover.sensors)
      for (const world::Setting& setting : sensor.settings)
        for (const double number : setting.numbers) require(std::isfinite(number));
  }
  for (const world::Path& path : world.paths) require(!path.pieces.empty());
  require(world::from_snapshot(world::snapshot(world)).hash == world.hash);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr const char* kFile = "/nowhere/fuzz.world";
  try {
    examine(world::build_world(kFile, std::string(reinterpret_cast<const char*>(data), size), {.sensors = kWords}));
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with(kFile));
  }
  return 0;
}
