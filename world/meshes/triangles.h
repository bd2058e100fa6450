#pragma once
// Triangles of a mesh file while it is read.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <glm/ext/vector_float2.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "world/material.h"

namespace sf::world {

inline constexpr std::size_t kMostMeshBytes = 0xFFFFFFFF;  ///< [bytes] of one file
inline constexpr std::size_t kMostTriangles = 16'000'000;  ///< of one file
inline constexpr double kMostCoordinate = 1e7;             ///< [m]

/// A picture that a mesh file names or contains.
struct TextureSource {
  std::string name;    ///< its file, or that of the mesh and which of its pictures
  std::string bytes;   ///< of the picture; empty: those of the file `name`
  bool alpha = false;  ///< its transparent parts shall not be seen
};

struct Triangles {
  std::vector<glm::dvec3> vertices;    ///< in the file's frame and unit, within kMostCoordinate
  std::vector<std::uint32_t> corners;  ///< three rows of `vertices` per triangle
  std::vector<Material> materials;
  std::vector<std::uint32_t> material_of;  ///< per triangle: row of `materials` or kNoMaterial; empty: none has one
  std::vector<TextureSource> textures;
  std::vector<TextureUse> texture_of;  ///< per material: row of `textures`; empty: none has one
  /// Texture coordinates per corner, as MeshTextures::corners; empty: none has any. Plug-ins: NaN: it has none.
  std::vector<glm::vec2> coordinates;
  std::vector<std::string> notes;  ///< warnings about omitted parts
};

/// A place in a file for errors: a line of a text, or an element of a binary file, both from 1.
struct MeshPlace {
  const char* kind;  ///< "line", "triangle", "vertex", "face"
  std::uint64_t number;
};

/// Collects triangles. Its checks throw base::InputError with the file and the place.
class TriangleBuilder {
 public:
  explicit TriangleBuilder(std::string file) : file_(std::move(file)) {}

  [[noreturn]] void fail(const MeshPlace& at, std::string_view message) const;
  [[noreturn]] void fail(std::string_view message) const;
  /// Refuses more than kMostTriangles, before memory is taken for them.
  void expect(std::uint64_t triangles) const;

  /// @throws for numbers that are not finite or too large
  void add_vertex(const glm::dvec3& p, const MeshPlace& at);
  std::size_t vertices() const { return out_.vertices.size(); }
  /// Appends a face as triangles around its first corner. @param corners rows of vertices added so far
  /// @param coordinates of the texture, per corner; empty: none
  /// @throws for other rows, fewer than three corners, and a face that is not convex
  void add_face(std::span<const std::uint64_t> corners, const MeshPlace& at,
                std::span<const glm::vec2> coordinates = {});
  std::uint32_t add_texture(TextureSource texture);
  /// Adds a material. Numbers of its colour beyond [0, 1] are clamped, with a note for the
  /// first. @param texture of one that was added, or kNoTexture @return its row
  /// @throws for a reflectance outside [0, kMostReflectance]
  std::uint32_t add_material(const std::string& name, Material material, const TextureUse& texture = {});
  /// Faces added from now on have this material. @param row of one that was added, or kNoMaterial
  void use_material(std::uint32_t row) { material_ = row; }
  void add_note(std::string note) { out_.notes.push_back(std::move(note)); }
  /// Appends unchecked triangles with their vertices, materials and notes.
  void add(const Triangles& part);

  /// Returns the triangles, and their vertices in order of first use. @throws for a file without triangles
  Triangles finish();

 private:
  bool is_convex(std::span<const std::uint64_t> corners) const;
  void add_coordinates(std::span<const glm::vec2> coordinates, std::size_t corners);

  std::string file_;
  Triangles out_;
  std::uint32_t material_ = kNoMaterial;
  bool clamped_ = false;  ///< a material's colour, of which one note is enough
  bool lacking_ = false;  ///< texture coordinates, of which one note is enough
};

/// Refuses XML that nests elements more than 1 000 deep: parsers recurse and would overflow the stack.
void refuse_deep_xml(const std::string& file, std::string_view bytes);

// Readers of one format each. @param bytes the whole file; `file` names it in errors
Triangles read_stl(const std::string& file, std::string_view bytes);
Triangles read_obj(const std::string& file, std::string_view bytes);
Triangles read_ply(const std::string& file, std::string_view bytes);
/// glTF, as text or binary, through a plug-in (world/gltf/).
Triangles read_gltf(const std::string& file, std::string_view bytes);
/// COLLADA, FBX and others, through a plug-in (world/assimp/).
Triangles read_other_mesh(const std::string& file, std::string_view bytes);
/// URDF: the robot with all joints at 0, through a plug-in (world/meshes/urdf_robot.h).
Triangles read_urdf(const std::string& file, std::string_view bytes);

/// The interface of plug-ins that read meshes. `read` fills in vertices, corners and materials, and does not
/// check them.
/// @throws base::InputError
struct MeshPlugin {
  void (*read)(const std::string& file, std::string_view bytes, Triangles& out);
};
/// Names of the plug-ins' only symbols: `extern "C" const MeshPlugin sensorfarm_gltf`.
inline constexpr const char* kGltfSymbol = "sensorfarm_gltf";
inline constexpr const char* kAssimpSymbol = "sensorfarm_assimp";

}  // namespace sf::world
