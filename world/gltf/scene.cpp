// The glTF plug-in: returns the triangles of a file's scene.

#include <fmt/format.h>
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/mat4x4.hpp>
#include <limits>

#include "base/elementary.h"
#include "base/error.h"
#include "world/meshes/triangles.h"

namespace sf::world {

namespace {

constexpr std::size_t kMostMessage = 300;  ///< [bytes] of the library's message, which may quote the file
constexpr int kMostDepth = 100;            ///< of nodes within nodes
constexpr std::uint64_t kMostNodes = 1'000'000;
constexpr float kNoCoordinate = std::numeric_limits<float>::quiet_NaN();

/// KHR_texture_transform: which coordinates of the vertices a texture has, and an affine map of these. Positive
/// rotations turn them counter-clockwise in the picture, whose v points down.
struct TextureTransform {
  int set = 0;
  glm::dvec2 offset{0.0}, scale{1.0};
  double cos = 1.0, sin = 0.0;

  glm::vec2 at(float u, float v) const {
    const double x = scale.x * u, y = scale.y * v;
    return {static_cast<float>(cos * x + sin * y + offset.x), static_cast<float>(cos * y - sin * x + offset.y)};
  }
};

TextureTransform texture_transform_of(const tinygltf::TextureInfo& info) {
  TextureTransform transform{.set = info.texCoord};
  const auto found = info.extensions.find("KHR_texture_transform");
  if (found == info.extensions.end()) return transform;
  const auto read_pair = [&](const char* key, glm::dvec2& pair) {
    if (!found->second.Has(key)) return;
    const tinygltf::Value& value = found->second.Get(key);
    for (int k = 0; k < 2 && value.IsArray() && value.ArrayLen() == 2; ++k)
      pair[k] = value.Get(k).IsNumber() ? value.Get(k).GetNumberAsDouble() : kNoCoordinate;
  };
  read_pair("offset", transform.offset), read_pair("scale", transform.scale);
  if (found->second.Has("texCoord") && found->second.Get("texCoord").IsInt())
    transform.set = found->second.Get("texCoord").GetNumberAsInt();
  if (found->second.Has("rotation") && found->second.Get("rotation").IsNumber()) {
    const double angle = found->second.Get("rotation").GetNumberAsDouble();
    if (!(std::abs(angle) < 1e6)) return transform;
    const auto [sin, cos] = base::sin_cos(angle);
    transform.sin = sin, transform.cos = cos;
  }
  return transform;
}

/// Refuses devices and pipes, since the URI of a buffer may name any path.
tinygltf::FsCallbacks regular_files() {
  tinygltf::FsCallbacks files{};
  files.FileExists = [](const std::string& path, void*) { return std::filesystem::is_regular_file(path); };
  files.ExpandFilePath = [](const std::string& path, void*) { return path; };
  files.ReadWholeFile = [](std::vector<unsigned char>* out, std::string* error, const std::string& path, void*) {
    std::error_code failure;
    const auto size = std::filesystem::file_size(path, failure);
    std::ifstream in(path, std::ios::binary);
    if (failure || size > kMostMeshBytes || !in) return *error += "cannot read " + path, false;
    out->resize(size);
    in.read(reinterpret_cast<char*>(out->data()), static_cast<std::streamsize>(size));
    return static_cast<std::uintmax_t>(in.gcount()) == size;
  };
  files.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  return files;
}

/// Keeps the encoded bytes of pictures in other files and in URIs. Those in buffers are within the model.
bool keep_picture(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                  int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + std::max(0, size));
  return true;
}

class SceneReader {
 public:
  SceneReader(std::string file, Triangles& out) : file_(std::move(file)), out_(out) {}
  void read(std::string_view bytes);

 private:
  [[noreturn]] void fail(const std::string& message) const { throw base::InputError(file_, 0, message); }
  void load(std::string_view bytes);
  void refuse_extensions() const;
  void refuse_depth(std::string_view bytes) const;
  void add_textures();
  TextureUse texture_of(const tinygltf::TextureInfo& info);
  void add_materials();
  void add_node(int row, const glm::dmat4& X_parent, int depth);
  void add_mesh(int row, const glm::dmat4& X);
  void add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& X);
  std::vector<glm::vec2> coordinates_of(const tinygltf::Primitive& primitive, std::uint64_t vertices) const;
  void add_triangles(int mode, std::span<const std::uint64_t> rows, std::uint64_t first,
                     std::span<const glm::vec2> coordinates);
  /// Returns the bytes of an accessor's first element. @throws unless all elements are within their buffer
  const unsigned char* data_of(const tinygltf::Accessor& accessor, std::size_t& stride) const;
  std::vector<std::uint64_t> rows_of(const tinygltf::Primitive& primitive, std::uint64_t vertices) const;
  template <class Rows>
  auto& checked(Rows& rows, int row, const char* what) const {
    if (row < 0 || static_cast<std::size_t>(row) >= rows.size())
      fail(fmt::format("refers to {} {}, which does not exist", what, row));
    return rows[static_cast<std::size_t>(row)];
  }

  std::string file_;
  Triangles& out_;
  tinygltf::Model model_;
  std::uint64_t nodes_ = 0;
};

void SceneReader::load(std::string_view bytes) {
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(regular_files());
  loader.SetImageLoader(keep_picture, nullptr);
  std::string error, warning, folder = std::filesystem::path(file_).parent_path().string();
  if (folder.empty()) folder = ".";
  const auto size = static_cast<unsigned>(bytes.size());
  const bool good =
      bytes.starts_with("glTF")
          ? loader.LoadBinaryFromMemory(&model_, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()),
                                        size, folder)
          : loader.LoadASCIIFromString(&model_, &error, &warning, bytes.data(), size, folder);
  while (!error.empty() && (error.back() == '\n' || error.back() == ' ')) error.pop_back();
  if (error.size() > kMostMessage) error = error.substr(0, kMostMessage) + " ...";
  if (!good) fail(fmt::format("is no readable glTF 2.0 file: {}", error.empty() ? "no reason is given" : error));
}

/// Refuses required extensions, except those of materials, textures and lights, which change no surface.
void SceneReader::refuse_extensions() const {
  constexpr std::string_view kHarmless[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_xmp"};
  for (const std::string& name : model_.extensionsRequired)
    if (std::none_of(std::begin(kHarmless), std::end(kHarmless), [&](auto begin) { return name.starts_with(begin); }))
      fail(fmt::format("requires {}, which is not read; expected a file without it: export it again", name));
}

/// Refuses deeply nested JSON: the parser recurses and would overflow the stack.
void SceneReader::refuse_depth(std::string_view bytes) const {
  constexpr std::size_t kHeader = 20, kMost = 1'000;
  std::uint32_t length = 0;
  if (bytes.starts_with("glTF") && bytes.size() >= kHeader) {
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    bytes = bytes.substr(kHeader, length);
  }
  std::size_t depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (quoted && bytes[i] == '\\')
      ++i;
    else if (bytes[i] == '"')
      quoted = !quoted;
    else if (!quoted && (bytes[i] == '[' || bytes[i] == '{') && ++depth > kMost)
      fail(fmt::format("nests brackets more than {} deep", kMost));
    else if (!quoted && (bytes[i] == ']' || bytes[i] == '}') && depth > 0)
      --depth;
  }
}

const unsigned char* SceneReader::data_of(const tinygltf::Accessor& accessor, std::size_t& stride) const {
  if (accessor.sparse.isSparse || accessor.bufferView < 0) fail("has a sparse accessor; expected numbers in a buffer");
  const tinygltf::BufferView& view = checked(model_.bufferViews, accessor.bufferView, "buffer view");
  const std::vector<unsigned char>& data = checked(model_.buffers, view.buffer, "buffer").data;
  const int step = accessor.ByteStride(view);
  const auto size =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)) *
                               tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
  stride = static_cast<std::size_t>(step);
  const std::size_t offset = view.byteOffset + accessor.byteOffset;
  const bool fits = step > 0 && offset >= view.byteOffset && offset <= data.size() && accessor.count > 0 && size > 0 &&
                    size <= data.size() - offset && (accessor.count - 1) <= (data.size() - offset - size) / stride;
  if (!fits)
    fail(fmt::format("has an accessor of {} elements beyond the {} bytes of its buffer", accessor.count, data.size()));
  return data.data() + offset;
}

/// Returns the rows of vertices that a primitive's triangles list.
std::vector<std::uint64_t> SceneReader::rows_of(const tinygltf::Primitive& primitive, std::uint64_t vertices) const {
  std::vector<std::uint64_t> rows;
  if (primitive.indices < 0) {
    for (std::uint64_t i = 0; i < vertices; ++i) rows.push_back(i);
    return rows;
  }
  const tinygltf::Accessor& accessor = checked(model_.accessors, primitive.indices, "accessor");
  std::size_t stride = 0;
  const unsigned char* data = data_of(accessor, stride);
  for (std::size_t i = 0; i < accessor.count; ++i, data += stride) {
    std::uint32_t row = 0;
    switch (accessor.componentType) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        row = *data;
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
        std::uint16_t v;
        std::memcpy(&v, data, sizeof v);
        row = v;
        break;
      }
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        std::memcpy(&row, data, sizeof row);
        break;
      default:
        fail("has indices that are no unsigned integers");
    }
    if (row >= vertices) fail(fmt::format("has a triangle with vertex {} of {}", row, vertices));
    rows.push_back(row);
  }
  return rows;
}

/// Returns the texture coordinates of a primitive's vertices; empty: it needs none, or has none.
std::vector<glm::vec2> SceneReader::coordinates_of(const tinygltf::Primitive& primitive, std::uint64_t vertices) const {
  if (primitive.material < 0) return {};
  const auto& info = checked(model_.materials, primitive.material, "material").pbrMetallicRoughness.baseColorTexture;
  const TextureTransform transform = texture_transform_of(info);
  const auto found = primitive.attributes.find(fmt::format("TEXCOORD_{}", transform.set));
  if (info.index < 0 || found == primitive.attributes.end()) return {};
  const tinygltf::Accessor& accessor = checked(model_.accessors, found->second, "accessor");
  const int type = accessor.componentType;
  const bool is_float = type == TINYGLTF_COMPONENT_TYPE_FLOAT, is_byte = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
  if (accessor.type != TINYGLTF_TYPE_VEC2 || accessor.count < vertices ||
      !(is_float || is_byte || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT))
    fail("has texture coordinates that are no pairs of floats, bytes or shorts for each vertex");
  std::size_t stride = 0;
  const unsigned char* data = data_of(accessor, stride);
  std::vector<glm::vec2> all;
  for (std::size_t i = 0; i < vertices; ++i, data += stride) {
    float c[2] = {data[0] / 255.0f, data[1] / 255.0f};
    std::uint16_t shorts[2];
    if (is_float) {
      std::memcpy(c, data, sizeof c);
    } else if (!is_byte) {
      std::memcpy(shorts, data, sizeof shorts);
      for (const int k : {0, 1}) c[k] = shorts[k] / 65535.0f;
    }
    all.push_back(transform.at(c[0], c[1]));
  }
  return all;
}

/// @param coordinates of the primitive's vertices, or empty
void SceneReader::add_triangles(int mode, std::span<const std::uint64_t> rows, std::uint64_t first,
                                std::span<const glm::vec2> coordinates) {
  if (!coordinates.empty()) out_.coordinates.resize(out_.corners.size(), glm::vec2(kNoCoordinate));
  const std::size_t step = mode == TINYGLTF_MODE_TRIANGLES ? 3 : 1;
  for (std::size_t i = 0; i + 2 < rows.size(); i += step) {
    const std::size_t start = mode == TINYGLTF_MODE_TRIANGLE_FAN ? 0 : i;
    for (const std::uint64_t row : {rows[start], rows[i + 1], rows[i + 2]}) {
      out_.corners.push_back(static_cast<std::uint32_t>(first + row));
      if (!coordinates.empty()) out_.coordinates.push_back(coordinates[row]);
    }
  }
  if (out_.corners.size() / 3 > kMostTriangles)
    fail(fmt::format("has more than {} triangles; expected at most that: simplify it", kMostTriangles));
}

void SceneReader::add_primitive(const tinygltf::Primitive& primitive, const glm::dmat4& X) {
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  const auto position = primitive.attributes.find("POSITION");
  if (mode < TINYGLTF_MODE_TRIANGLES || position == primitive.attributes.end()) return;  // points and lines
  const tinygltf::Accessor& accessor = checked(model_.accessors, position->second, "accessor");
  if (accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT || accessor.type != TINYGLTF_TYPE_VEC3)
    fail("has positions that are no vectors of three floats");
  std::size_t stride = 0;
  const unsigned char* data = data_of(accessor, stride);
  const std::uint64_t first = out_.vertices.size();
  if (first + accessor.count > 3 * kMostTriangles) fail("has too many vertices: simplify it");
  for (std::size_t i = 0; i < accessor.count; ++i, data += stride) {
    float p[3];
    std::memcpy(p, data, sizeof p);
    const glm::dvec4 q = X * glm::dvec4(p[0], p[1], p[2], 1.0);
    out_.vertices.emplace_back(q.x, -q.z, q.y);  // y is up in glTF
  }
  const std::size_t before = out_.corners.size() / 3;
  add_triangles(mode, rows_of(primitive, accessor.count), first, coordinates_of(primitive, accessor.count));
  if (primitive.material < 0) return;
  checked(model_.materials, primitive.material, "material");
  out_.material_of.resize(before, kNoMaterial);
  out_.material_of.resize(out_.corners.size() / 3, static_cast<std::uint32_t>(primitive.material));
}

/// Adds the pictures of all textures, by row of the file's images.
void SceneReader::add_textures() {
  for (std::size_t row = 0; row < model_.images.size(); ++row) {
    tinygltf::Image& image = model_.images[row];
    TextureSource source{.name = fmt::format("{}, image {}", file_, row)};
    if (image.bufferView >= 0) {
      const tinygltf::BufferView& view = checked(model_.bufferViews, image.bufferView, "buffer view");
      const std::vector<unsigned char>& data = checked(model_.buffers, view.buffer, "buffer").data;
      if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        fail(fmt::format("has image {} beyond the {} bytes of its buffer", row, data.size()));
      source.bytes.assign(reinterpret_cast<const char*>(data.data()) + view.byteOffset, view.byteLength);
    } else {
      source.bytes.assign(image.image.begin(), image.image.end());
      image.image = {};
    }
    if (!image.uri.empty()) source.name = (std::filesystem::path(file_).parent_path() / image.uri).string();
    out_.textures.push_back(std::move(source));
  }
}

TextureUse SceneReader::texture_of(const tinygltf::TextureInfo& info) {
  if (info.index < 0) return {};
  const tinygltf::Texture& texture = checked(model_.textures, info.index, "texture");
  if (texture.source < 0) {
    out_.notes.push_back(fmt::format("texture {} is left out: it has no image in PNG or JPEG", info.index));
    return {};
  }
  checked(model_.images, texture.source, "image");
  TextureUse use{.texture = static_cast<std::uint32_t>(texture.source)};
  if (texture.sampler < 0) return use;
  const tinygltf::Sampler& sampler = checked(model_.samplers, texture.sampler, "sampler");
  const auto wrap_of = [](int mode) {
    return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? TextureWrap::clamp
           : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? TextureWrap::mirror
                                                           : TextureWrap::repeat;
  };
  use.u = wrap_of(sampler.wrapS), use.v = wrap_of(sampler.wrapT);
  return use;
}

/// The reflectance is the number `extras.reflectance` of a material, else the luminance of its base colour. Textured
/// materials have the default: the factor of a texture states nothing about it.
void SceneReader::add_materials() {
  for (const tinygltf::Material& from : model_.materials) {
    Material material;
    const std::vector<double>& factor = from.pbrMetallicRoughness.baseColorFactor;
    if (factor.size() >= 3) material.color = {factor[0], factor[1], factor[2]};
    const bool textured = from.pbrMetallicRoughness.baseColorTexture.index >= 0 ||
                          from.extensions.contains("KHR_materials_pbrSpecularGlossiness");
    if (!textured) material.reflectance = luminance(material.color);
    if (from.extras.Has("reflectance")) {
      const tinygltf::Value& stated = from.extras.Get("reflectance");
      if (!stated.IsNumber()) fail(fmt::format("has the material '{}' whose 'reflectance' is no number", from.name));
      material.reflectance = stated.GetNumberAsDouble();
    }
    const TextureUse use = texture_of(from.pbrMetallicRoughness.baseColorTexture);
    if (use.texture != kNoTexture && from.alphaMode != "OPAQUE") out_.textures[use.texture].alpha = true;
    out_.materials.push_back(material);
    out_.texture_of.push_back(use);
  }
}

void SceneReader::add_mesh(int row, const glm::dmat4& X) {
  for (const tinygltf::Primitive& primitive : checked(model_.meshes, row, "mesh").primitives)
    add_primitive(primitive, X);
}

glm::dmat4 transform_of(const tinygltf::Node& node) {
  if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
  glm::dmat4 X(1.0);
  if (node.rotation.size() == 4)
    X = glm::mat4_cast(glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
  if (node.scale.size() == 3)
    for (int k = 0; k < 3; ++k) X[k] *= node.scale[static_cast<std::size_t>(k)];
  if (node.translation.size() == 3) X[3] = {node.translation[0], node.translation[1], node.translation[2], 1.0};
  return X;
}

void SceneReader::add_node(int row, const glm::dmat4& X_parent, int depth) {
  if (depth > kMostDepth || ++nodes_ > kMostNodes)
    fail(fmt::format("has nodes within nodes without end, or more than {}", kMostNodes));
  const tinygltf::Node& node = checked(model_.nodes, row, "node");
  const glm::dmat4 X = X_parent * transform_of(node);
  if (node.mesh >= 0) add_mesh(node.mesh, X);
  for (const int child : node.children) add_node(child, X, depth + 1);
}

void SceneReader::read(std::string_view bytes) {
  refuse_depth(bytes);
  load(bytes);
  refuse_extensions();
  add_textures();
  add_materials();
  if (model_.scenes.empty()) {
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes)
      for (const int child : node.children)
        if (child >= 0 && static_cast<std::size_t>(child) < is_child.size())
          is_child[static_cast<std::size_t>(child)] = true;
    for (std::size_t row = 0; row < model_.nodes.size(); ++row)
      if (!is_child[row]) add_node(static_cast<int>(row), glm::dmat4(1.0), 0);
    return;
  }
  for (const int node : checked(model_.scenes, std::max(0, model_.defaultScene), "scene").nodes)
    add_node(node, glm::dmat4(1.0), 0);
}

void read(const std::string& file, std::string_view bytes, Triangles& out) {
  SceneReader(file, out).read(bytes);
  if (!out.material_of.empty()) out.material_of.resize(out.corners.size() / 3, kNoMaterial);
  if (!out.coordinates.empty()) out.coordinates.resize(out.corners.size(), glm::vec2(kNoCoordinate));
}

}  // namespace

extern "C" {
extern const MeshPlugin sensorfarm_gltf;
const MeshPlugin sensorfarm_gltf{read};
}

}  // namespace sf::world
