// libFuzzer target: any bytes as a file of triangles, or of their materials. The first byte chooses the format.

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>

#include "base/error.h"
#include "tests/fuzz/require.h"
#include "world/meshes/mtl.h"
#include "world/meshes/triangles.h"

using namespace sf;

extern "C" const world::MeshPlugin sensorfarm_gltf;  // compiled in

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  constexpr std::array kReaders{world::read_stl, world::read_obj, world::read_ply};
  try {
    const std::size_t format = data[0] % 5;
    if (format == 4) {
      std::map<std::string, world::MtlMaterial, std::less<>> materials;
      world::read_mtl(bytes, materials);
      return 0;
    }
    world::Triangles found;
    if (format == kReaders.size()) {
      world::TriangleBuilder builder("fuzz.mesh");
      sensorfarm_gltf.read("fuzz.mesh", bytes, found);
      builder.add(found);
      found = builder.finish();
    } else {
      found = kReaders[format]("fuzz.mesh", bytes);
      require(found.vertices.size() <= size);
    }
    require(!found.corners.empty() && found.corners.size() % 3 == 0);
    for (const glm::dvec3& p : found.vertices)
      require(std::abs(p.x) <= world::kMostCoordinate && std::abs(p.y) <= world::kMostCoordinate &&
              std::abs(p.z) <= world::kMostCoordinate);
    for (const std::uint32_t corner : found.corners) require(corner < found.vertices.size());
    require(found.material_of.empty() || found.material_of.size() == found.corners.size() / 3);
    for (const std::uint32_t material : found.material_of)
      require(material < found.materials.size() || material == world::kNoMaterial);
    require(found.coordinates.empty() || found.coordinates.size() == found.corners.size());
    for (const glm::vec2& c : found.coordinates)
      require(std::abs(c.x) <= world::kMostTextureCoordinate && std::abs(c.y) <= world::kMostTextureCoordinate);
    require(found.texture_of.empty() || found.texture_of.size() == found.materials.size());
    for (const world::TextureUse& use : found.texture_of)
      require(use.texture < found.textures.size() || use.texture == world::kNoTexture);
    for (const world::Material& material : found.materials)
      require(material.reflectance >= 0.0 && material.reflectance <= world::kMostReflectance);
  } catch (const base::InputError& error) {
    require(std::string_view(error.what()).starts_with("fuzz.mesh"));
  }
  return 0;
}
