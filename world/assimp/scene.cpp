// The Assimp plug-in: returns the triangles of a scene in a format that no other reader knows, such as COLLADA and FBX.

#include <fmt/format.h>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>
#include <filesystem>

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
  void add_node(const aiNode& node, const aiMatrix4x4& X_parent, int depth);
  void add_mesh(const aiMesh& mesh, const aiMatrix4x4& X);

  std::string file_;
  Triangles& out_;
  Assimp::Importer importer_;
  const aiScene* scene_ = nullptr;
};

void SceneReader::add_mesh(const aiMesh& mesh, const aiMatrix4x4& X) {
  if ((mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE) == 0) return;  // points and lines
  const std::size_t first = out_.vertices.size();
  if (out_.corners.size() / 3 + mesh.mNumFaces > kMostTriangles || first + mesh.mNumVertices > 3 * kMostTriangles)
    fail(fmt::format("has more than {} triangles; expected at most that: simplify it", kMostTriangles));
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D p = X * mesh.mVertices[i];
    out_.vertices.emplace_back(p.x, p.y, p.z);
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices != 3) continue;
    for (unsigned k = 0; k < 3; ++k) out_.corners.push_back(static_cast<std::uint32_t>(first + face.mIndices[k]));
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
  scene_ = importer_.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_Triangulate | aiProcess_SortByPType,
                                        ending.empty() ? "" : ending.c_str() + 1);
  if (scene_ == nullptr || scene_->mRootNode == nullptr)
    fail(fmt::format("is no readable mesh: {}", importer_.GetErrorString()));
  add_node(*scene_->mRootNode, aiMatrix4x4(), 0);
}

void read(const std::string& file, std::string_view bytes, Triangles& out) { SceneReader(file, out).read(bytes); }

}  // namespace

extern "C" {
extern const MeshPlugin sensorfarm_assimp;
const MeshPlugin sensorfarm_assimp{read};
}

}  // namespace sf::world
