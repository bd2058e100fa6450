// libFuzzer target: any bytes as a robot in URDF.

#include <cmath>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/meshes/triangles.h"

using namespace sf;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size > 1u << 16) return 0;  // the parser alone takes seconds of megabytes
  try {
    const world::Triangles found = world::read_urdf("fuzz.urdf", {reinterpret_cast<const char*>(data), size});
    require(!found.corners.empty() && found.corners.size() % 3 == 0);
    for (const glm::dvec3& p : found.vertices)
      require(std::abs(p.x) <= world::kMostCoordinate && std::abs(p.y) <= world::kMostCoordinate &&
              std::abs(p.z) <= world::kMostCoordinate);
    for (const std::uint32_t corner : found.corners) require(corner < found.vertices.size());
    require(found.material_of.empty() || found.material_of.size() == found.corners.size() / 3);
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with("fuzz.urdf"));
  }
  return 0;
}
