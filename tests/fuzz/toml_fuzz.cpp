// libFuzzer target: any bytes as TOML, as scenario files and sidecars of road networks are read.

#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/toml.h"

namespace {

using namespace sf;

int depth_of(const world::TomlNode& node) {
  int deepest = 0;
  for (const world::TomlNode& item : node.items) deepest = std::max(deepest, depth_of(item));
  return deepest + 1;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto root = world::parse_toml("fuzz.toml", {reinterpret_cast<const char*>(data), size});
    require(root.kind == world::TomlNode::Kind::table && depth_of(root) <= 33);
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with("fuzz.toml"));
  }
  return 0;
}
