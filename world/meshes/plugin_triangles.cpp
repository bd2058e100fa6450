// Checks the triangles that plug-ins find in files.

#include <fmt/format.h>

#include <cctype>
#include <string>

#include "base/plugin.h"
#include "world/meshes/triangles.h"

namespace sf::world {

namespace {

const MeshPlugin& plugin_named(const char* name, const char* library) {
  return *static_cast<const MeshPlugin*>(
      base::load_plugin(name, "this mesh cannot be read, but STL, OBJ and PLY", library));
}

Triangles read_with(const MeshPlugin& plugin, const std::string& file, std::string_view bytes) {
  Triangles found;
  plugin.read(file, bytes, found);
  TriangleBuilder out(file);
  out.add(found);
  return out.finish();
}

}  // namespace

void refuse_deep_xml(const std::string& file, std::string_view bytes) {
  constexpr int kMost = 1'000;
  int depth = 0;
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i) {
    const bool letter = std::isalpha(static_cast<unsigned char>(bytes[i + 1])) != 0;
    if (bytes[i] == '<' && bytes[i + 1] == '/') --depth;
    if (bytes[i] == '/' && bytes[i + 1] == '>') --depth;
    if (bytes[i] == '<' && letter && ++depth > kMost)
      TriangleBuilder(file).fail(fmt::format("nests elements more than {} deep", kMost));
  }
}

Triangles read_gltf(const std::string& file, std::string_view bytes) {
  static const MeshPlugin& plugin = plugin_named(kGltfSymbol, "tinygltf 2.7 (Debian: libtinygltf2d)");
  return read_with(plugin, file, bytes);
}

Triangles read_other_mesh(const std::string& file, std::string_view bytes) {
  if (bytes.find("<COLLADA") != std::string_view::npos) refuse_deep_xml(file, bytes);
  static const MeshPlugin& plugin = plugin_named(kAssimpSymbol, "Assimp 5.2 (Debian: libassimp5)");
  return read_with(plugin, file, bytes);
}

}  // namespace sf::world
