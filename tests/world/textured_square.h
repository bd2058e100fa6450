#pragma once
// A square with a picture, as binary glTF.

#include <array>
#include <cstdint>
#include <string>

#include "base/png.h"

namespace sf::world {

/// In the plane x = 0, from y = -0.5 to 0.5 and z = 0 to 1. Seen along x, its picture is upright.
struct TexturedSquare {
  std::array<float, 8> coordinates{0, 0, 1, 0, 1, 1, 0, 1};  ///< u and v from the top left corner clockwise
  std::string picture;                                       ///< bytes of a file
  std::string image = R"({"bufferView":3,"mimeType":"image/png"})";
  std::string info = "";      ///< of the texture, such as `,"extensions":{}`
  std::string material = "";  ///< such as `,"alphaMode":"MASK"`
  std::string factor = "[1,1,1,1]";
  std::string sampler = "{}";
};

/// Returns a picture whose pixels have the colours 0xRRGGBB.
inline std::string png_of(std::initializer_list<std::uint32_t> colors, int width) {
  std::vector<std::uint8_t> pixels;
  for (const std::uint32_t color : colors)
    for (const int shift : {16, 8, 0}) pixels.push_back(static_cast<std::uint8_t>(color >> shift));
  return base::encode_png(pixels, width, static_cast<int>(colors.size()) / width);
}

inline std::string glb_of(const TexturedSquare& square) {
  const auto raw = [](const auto& value) { return std::string(reinterpret_cast<const char*>(&value), sizeof value); };
  const float corners[4][3] = {{0, 1, -0.5f}, {0, 1, 0.5f}, {0, 0, 0.5f}, {0, 0, -0.5f}};  // y is up, z is -y here
  const std::uint16_t triangles[6] = {0, 1, 2, 0, 2, 3};
  std::string data = raw(corners) + raw(square.coordinates) + raw(triangles) + square.picture;
  std::string text =
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
      R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"indices":2,"material":0}]}],"materials":[{"name":"m",)"
      R"("pbrMetallicRoughness":{"baseColorFactor":)" +
      square.factor + R"(,"baseColorTexture":{"index":0)" + square.info + "}}" + square.material +
      R"(}],"textures":[{"source":0,"sampler":0}],"samplers":[)" + square.sampler + R"(],"images":[)" + square.image +
      R"(],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
      R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"},)"
      R"({"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":48},)"
      R"({"buffer":0,"byteOffset":48,"byteLength":32},{"buffer":0,"byteOffset":80,"byteLength":12},)"
      R"({"buffer":0,"byteOffset":92,"byteLength":)" +
      std::to_string(square.picture.size()) + R"(}],"buffers":[{"byteLength":)" + std::to_string(data.size()) + "}]}";
  text.resize((text.size() + 3) / 4 * 4, ' '), data.resize((data.size() + 3) / 4 * 4, '\0');
  const auto size = [&](const std::string& part) { return raw(static_cast<std::uint32_t>(part.size())); };
  const std::string chunks = size(text) + "JSON" + text + size(data) + std::string("BIN\0", 4) + data;
  return "glTF" + raw(std::uint32_t{2}) + raw(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

}  // namespace sf::world
