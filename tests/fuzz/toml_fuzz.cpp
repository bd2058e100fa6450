// libFuzzer target: any bytes as TOML, read as scenario files, as sidecars of road networks, and as a plan of lights,
// which runs for a while.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/actuated_lights.h"
#include "world/light_plan.h"
#include "world/toml.h"

namespace {

using namespace sf;

int depth_of(const world::TomlNode& node) {
  int deepest = 0;
  for (const world::TomlNode& item : node.items) deepest = std::max(deepest, depth_of(item));
  return deepest + 1;
}

/// Two lights; whatever the plan, each has a state at any time.
void run_plan(const std::string& text) {
  world::World world;
  for (const char* name : {"a", "b"}) {
    world.lights.emplace_back().name = name;
    world.lights.back().phases = {{world::LightState::red, 1.0}};
  }
  const world::LightPlan plan = world::parse_light_plan("fuzz.toml", text, world);
  world::ActuatedLights lights(world, plan);
  for (double time = 0.0; time < 20.0; time += 0.5) {
    lights.detect({0.0, 0.0}, time);
    lights.step(time);
    for (const world::SignalForecast& light : lights.forecasts(time))
      require(light.now.left >= 0.0 && light.latest >= light.now.left);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto root = world::parse_toml("fuzz.toml", {reinterpret_cast<const char*>(data), size});
    require(root.kind == world::TomlNode::Kind::table && depth_of(root) <= 33);
    run_plan({reinterpret_cast<const char*>(data), size});
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with("fuzz.toml"));
  }
  return 0;
}
