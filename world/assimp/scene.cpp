// The Assimp plug-in: returns the triangles of a scene in a format that no other reader knows, such as COLLADA and FBX,
// with their materials and textures.

#include <fmt/format.h>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <algorithm>
#include <assimp/Importer.hpp>
#include <filesystem>
#include <limits>

#include "base/error.h"
#include "world/meshes/triangles.h"

namespace sf::world {

namespace {

constexpr int kMostDepth = 100;  ///< of nodes within nodes

class SceneReader {
 public:
  SceneReader(const std::string& file, Triangles& out) : file_(file), out_(out) {}
  void read(std::string_view bytes);

 private:
  [[noreturn]] void fail(const std::string& message) const { throw base::InputError(file_, 0, message); }
  void add_materials();
  std::uint32_t add_texture(const std::string& name);
  void add_coordinates(const aiMesh& mesh, const aiFace& face);
  void add_node(const aiNode& node, const aiMatrix4x4& X_parent, int depth);
  void add_mesh(const aiMesh& mesh, const aiMatrix4x4& X);

  std::string file_;
  Triangles& out_;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
};

TextureWrap wrap_of(aiTextureMapMode mode) {
  return mode == aiTextureMapMode_Wrap     ? TextureWrap::repeat
         : mode == aiTextureMapMode_Mirror ? TextureWrap::mirror
                                           : TextureWrap::clamp;
}

/// Adds a picture of the scene, or of a file in its folder. @return its row
std::uint32_t SceneReader::add_texture(const std::string& name) {
  TextureSource source{.name = fmt::format("{}, image '{}'", file_, name)};
  const aiTexture* const within = scene_->GetEmbeddedTexture(name.c_str());
  if (within != nullptr && within->mHeight == 0)
    source.bytes.assign(reinterpret_cast<const char*>(within->pcData), within->mWidth);
  if (source.bytes.empty()) {
    std::string path = name;
    std::ranges::replace(path, '\\', '/');  // as written on Windows
    source.name = (std::filesystem::path(file_).parent_path() / path).string();
  }
  const auto known = std::ranges::find(out_.textures, source.name, &TextureSource::name);
  const auto row = static_cast<std::uint32_t>(known - out_.textures.begin());
  if (known == out_.textures.end()) out_.textures.push_back(std::move(source));
  return row;
}

/// A material has a diffuse colour, taken as linear, or a texture in its place.
void SceneReader::add_materials() {
  for (unsigned i = 0; i < scene_->mNumMaterials; ++i) {
    const aiMaterial& from = *scene_->mMaterials[i];
    Material material;
    TextureUse use;
    aiColor3D color(0.5f, 0.5f, 0.5f);
    aiString picture;
    aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (from.GetTexture(aiTextureType_DIFFUSE, 0, &picture, nullptr, nullptr, nullptr, nullptr, modes) == AI_SUCCESS) {
      use = {add_texture(picture.C_Str()), wrap_of(modes[0]), wrap_of(modes[1])};
      material.color = glm::dvec3(1.0);
    } else if (from.Get(AI_MATKEY_COLOR_DIFFUSE, color) == AI_SUCCESS) {
      material.color = {color.r, color.g, color.b};
      material.reflectance = std::clamp(luminance(material.color), 0.0, 1.0);
    }
    out_.materials.push_back(material);
    out_.texture_of.push_back(use);
  }
}

void SceneReader::add_coordinates(const aiMesh& mesh, const aiFace& face) {
  const aiVector3D* const all = mesh.mTextureCoords[0];
  const float none = std::numeric_limits<float>::quiet_NaN();
  for (unsigned k = 0; k < 3; ++k)
    out_.coordinates.push_back(all == nullptr ? glm::vec2(none)
                                              : glm::vec2(all[face.mIndices[k]].x, all[face.mIndices[k]].y));
}

void SceneReader::add_mesh(const aiMesh& mesh, const aiMatrix4x4& X) {
  if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) return;  // points and lines
  const std::size_t first = out_.vertices.size();
  if (out_.corners.size() / 3 + mesh.mNumFaces > kMostTriangles || first + mesh.mNumVertices > 3 * kMostTriangles)
    fail(fmt::format("has more than {} triangles; expected at most that: simplify it", kMostTriangles));
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D p = X * mesh.mVertices[i];
    out_.vertices.emplace_back(p.x, p.y, p.z);
  }
  const bool stated = mesh.mMaterialIndex < scene_->mNumMaterials &&
                      scene_->mMaterials[mesh.mMaterialIndex]->GetName() != aiString(AI_DEFAULT_MATERIAL_NAME);
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;
    for (unsigned k = 0; k < 3; ++k) out_.corners.push_back(static_cast<std::uint32_t>(first + face.mIndices[k]));
    add_coordinates(mesh, face);
    out_.material_of.push_back(stated ? mesh.mMaterialIndex : kNoMaterial);
  }
}

void SceneReader::add_node(const aiNode& node, const aiMatrix4x4& X_parent, int depth) {
  if (depth > kMostDepth) fail(fmt::format("has more than {} nodes within nodes", kMostDepth));
  const aiMatrix4x4 X = X_parent * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) add_mesh(*scene_->mMeshes[node.mMeshes[i]], X);
  for (unsigned i = 0; i < node.mNumChildren; ++i) add_node(*node.mChildren[i], X, depth + 1);
}

void SceneReader::read(std::string_view bytes) {
  // As ROS and Gazebo read COLLADA: in the file's own axes.
  importer_.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const std::string ending = std::filesystem::path(file_).extension().string();
  scene_ = importer_.ReadFileFromMemory(bytes.data(), bytes.size(),
                                        aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_FlipUVs,
                                        ending.empty() ? "" : ending.c_str() + 1);
  if (scene_ == nullptr || scene_->mRootNode == nullptr)
    fail(fmt::format("is no readable mesh: {}", importer_.GetErrorString()));
  add_materials();
  add_node(*scene_->mRootNode, aiMatrix4x4(), 0);
  const auto is_none = [](std::uint32_t material) { return material == kNoMaterial; };
  if (std::ranges::all_of(out_.material_of, is_none)) out_.material_of.clear();
}

void read(const std::string& file, std::string_view bytes, Triangles& out) { SceneReader(file, out).read(bytes); }

}  // namespace

extern "C" {
extern const MeshPlugin sensorfarm_assimp;
const MeshPlugin sensorfarm_assimp{read};
}

}  // namespace sf::world
