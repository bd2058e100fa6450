// Checks the triangles that the plug-in finds in a glTF file.

#include <array>

#include "base/plugin.h"
#include "world/meshes/triangles.h"

namespace sf::world {

Triangles read_gltf(const std::string& file, std::string_view bytes) {
  static const auto& plugin = *static_cast<const GltfPlugin*>(base::load_plugin(
      kGltfSymbol, "meshes can be read from STL, OBJ and PLY only", "tinygltf 2.7 (Debian: libtinygltf2d)"));
  Triangles found;
  plugin.read(file, bytes, found);
  TriangleBuilder out(file);
  out.expect(found.corners.size() / 3);
  std::uint64_t number = 0;
  for (const glm::dvec3& p : found.vertices) out.add_vertex(p, {"vertex", ++number});
  for (std::size_t i = 0; i + 2 < found.corners.size(); i += 3)
    out.add_face(std::array<std::uint64_t, 3>{found.corners[i], found.corners[i + 1], found.corners[i + 2]},
                 {"triangle", i / 3 + 1});
  return out.finish();
}

}  // namespace sf::world
