#include "world/meshes/textures.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/files.h"
#include "world/meshes/mesh_file.h"
#include "world/picture.h"

namespace sf::world {

namespace {

/// @return whether a camera computes colours
bool sees_colours(const Mover& mover) {
  return std::ranges::any_of(mover.sensors, [](const Sensor& sensor) {
    return sensor.type == "camera" && std::ranges::any_of(sensor.settings, [](const Setting& setting) {
             const bool wanted = setting.key == "rgb" || setting.key == "mono";
             return wanted && !setting.numbers.empty() && setting.numbers[0] != 0.0;
           });
  });
}

/// Converts a picture to a texture.
class TextureBuilder final : public PictureSink {
 public:
  /// @param free number of further texels that a world may have
  TextureBuilder(const std::string& file, std::size_t free) : PictureSink(file, kMostTextureSide), free_(free) {}
  void add(const PixelRow& row) override {
    for (std::size_t i = 0; i < row.rgba.size(); i += 4) {
      texture.rgb.insert(texture.rgb.end(), &row.rgba[i], &row.rgba[i] + 3);
      transparent = transparent || row.rgba[i + 3] < 255;
    }
  }
  Texture texture;
  bool transparent = false;

 private:
  void start() override {
    if (std::size_t{width()} * height() > free_)
      throw base::InputError(file(), 0,
                             fmt::format("is one texture too many: those of a world have at most {} pixels in all; "
                                         "scale them down",
                                         kMostTexels));
    texture.file = file(), texture.width = width(), texture.height = height();
  }
  std::size_t free_;
};

/// Textures of a world while they are read.
class TextureReader {
 public:
  explicit TextureReader(World& world) : world_(world) {
    for (std::uint32_t row = 0; row < world.textures.size(); ++row)
      free_ -= world.textures[row].rgb.size() / 3, rows_.emplace(world.textures[row].file, row);
  }
  /// Adds the textures of a mesh. @param from its file
  void add(std::uint32_t mesh, const MeshMaterials& materials, const Triangles& from);
  void warn(const std::string& file, const std::string& message) {
    const Warning warning{file, 0, message};
    if (std::ranges::find(world_.warnings, warning) == world_.warnings.end()) world_.warnings.push_back(warning);
  }

 private:
  std::uint32_t row_of(const TextureSource& source, const std::string& mesh);

  World& world_;
  std::size_t free_ = kMostTexels;
  std::map<std::string, std::uint32_t> rows_;  ///< by name
};

/// Returns the row of a texture, which is read at its first use, or kNoTexture.
std::uint32_t TextureReader::row_of(const TextureSource& source, const std::string& mesh) {
  const auto [known, is_new] = rows_.try_emplace(source.name, kNoTexture);
  if (!is_new) return known->second;
  try {
    TextureBuilder builder(source.name, free_);
    decode_picture(source.bytes.empty() ? base::read_bytes(source.name, kMostPictureBytes) : source.bytes, builder);
    if (source.alpha && builder.transparent)
      warn(mesh, fmt::format("transparent parts of the texture {} are opaque here", source.name));
    free_ -= builder.texture.rgb.size() / 3;
    known->second = static_cast<std::uint32_t>(world_.textures.size());
    world_.textures.push_back(std::move(builder.texture));
  } catch (const base::InputError& error) {
    warn(mesh, fmt::format("a texture is left out: {}", error.what()));
  }
  return known->second;
}

void TextureReader::add(std::uint32_t mesh, const MeshMaterials& materials, const Triangles& from) {
  const std::vector<std::uint32_t>& corners = world_.meshes[mesh].corners;
  MeshTextures out{.mesh = mesh};
  // Flat triangles of the file have been left out.
  for (std::size_t i = 0; i < from.corners.size() && out.corners.size() < corners.size(); i += 3) {
    const std::size_t k = out.corners.size();
    if (std::equal(&from.corners[i], &from.corners[i] + 3, &corners[k]))
      out.corners.insert(out.corners.end(), &from.coordinates[i], &from.coordinates[i] + 3);
  }
  if (out.corners.size() != corners.size() || from.texture_of.size() != materials.materials.size())
    return warn(world_.meshes[mesh].file, "has changed since the world was read; its textures are left out");
  bool any = false;
  for (TextureUse use : from.texture_of) {
    if (use.texture != kNoTexture) use.texture = row_of(from.textures[use.texture], world_.meshes[mesh].file);
    any = any || use.texture != kNoTexture;
    out.materials.push_back(use);
  }
  if (any) world_.mesh_textures.push_back(std::move(out));
}

}  // namespace

bool read_textures(World& world, std::map<std::string, Triangles>& files) {
  if (std::ranges::none_of(world.movers, sees_colours)) return false;
  const std::size_t before = world.mesh_textures.size();
  TextureReader reader(world);
  for (const MeshMaterials& row : world.mesh_materials) {
    if (std::ranges::find(world.mesh_textures, row.mesh, &MeshTextures::mesh) != world.mesh_textures.end()) continue;
    const std::string& file = world.meshes[row.mesh].file;
    try {
      const auto [known, is_new] = files.try_emplace(file);
      if (is_new) known->second = read_triangles(file);
      if (!known->second.coordinates.empty()) reader.add(row.mesh, row, known->second);
    } catch (const base::InputError& error) {
      reader.warn(file, fmt::format("its textures are left out: {}", error.what()));
    }
  }
  return world.mesh_textures.size() > before;
}

}  // namespace sf::world
