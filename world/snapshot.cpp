#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "world/meshes/triangles.h"
#include "world/serialization.h"
#include "world/shapes.h"
#include "world/terrain.h"

namespace sf::world {

namespace {

constexpr std::uint32_t kMagic = 0x57574653u;  // "SFWW"
constexpr std::uint16_t kVersion = 16;
// Older versions lack the last fields of World. The oldest version is written that has all fields other than zero.
constexpr std::uint16_t kOldestVersion = 5;
constexpr std::size_t kSinceVersion16 =
    least_bytes<std::vector<GroundReflectance>>() + least_bytes<std::vector<BeamTable>>();
constexpr std::size_t kSinceVersion15 = least_bytes<std::vector<Texture>>() + least_bytes<std::vector<MeshTextures>>();
constexpr std::size_t kSinceVersion14 =
    least_bytes<std::vector<MeshMaterials>>() + least_bytes<std::vector<Daylight>>();
constexpr std::size_t kSinceVersion13 = least_bytes<std::vector<Reflectance>>() + least_bytes<std::vector<Terrain>>();
constexpr std::size_t kSinceVersion12 = least_bytes<std::vector<Mesh>>() + least_bytes<std::vector<MeshModel>>();
constexpr std::size_t kSinceVersion11 = least_bytes<bool>();
constexpr std::size_t kSinceVersion10 = least_bytes<std::vector<Variation>>();
constexpr std::size_t kSinceVersion9 = least_bytes<std::vector<HeatSource>>() + sizeof(double);
constexpr std::size_t kSinceVersion8 = least_bytes<std::vector<Shape>>();
constexpr std::size_t kSinceVersion7 = least_bytes<std::vector<Ramp>>() + least_bytes<std::vector<MarkingHeights>>() +
                                       least_bytes<std::vector<Fiducial>>();
constexpr std::size_t kSinceVersion6 = least_bytes<glm::dvec3>() + least_bytes<std::vector<Lamp>>() + sizeof(double);

std::uint16_t version_of(const World& world) {
  if (!world.ground.empty() || !world.beam_tables.empty()) return 16;
  if (!world.textures.empty() || !world.mesh_textures.empty()) return 15;
  if (!world.mesh_materials.empty() || !world.daylight.empty()) return 14;
  if (!world.reflectances.empty() || !world.terrain.empty()) return 13;
  if (!world.meshes.empty() || !world.mesh_models.empty()) return 12;
  if (world.floor_unseen) return 11;
  if (!world.variations.empty()) return 10;
  if (!world.heat_sources.empty() || world.temperature != 0.0) return 9;
  if (!world.shapes.empty()) return 8;
  if (!world.ramps.empty() || !world.marking_heights.empty() || !world.fiducials.empty()) return 7;
  return world.earth_field == glm::dvec3{} && world.lamps.empty() && world.ambient_light == 0.0 ? 5 : 6;
}

/// Returns the size of the fields that a version lacks, where they are zero.
std::size_t missing_bytes(std::uint16_t version) {
  return (version < 6 ? kSinceVersion6 : 0) + (version < 7 ? kSinceVersion7 : 0) + (version < 8 ? kSinceVersion8 : 0) +
         (version < 9 ? kSinceVersion9 : 0) + (version < 10 ? kSinceVersion10 : 0) +
         (version < 11 ? kSinceVersion11 : 0) + (version < 12 ? kSinceVersion12 : 0) +
         (version < 13 ? kSinceVersion13 : 0) + (version < 14 ? kSinceVersion14 : 0) +
         (version < 15 ? kSinceVersion15 : 0) + (version < 16 ? kSinceVersion16 : 0);
}

[[noreturn]] void refuse(const std::string& reason) { throw base::InputError("corrupt world snapshot: " + reason); }

// Checks that row numbers refer to existing rows, because users of a world rely on it.
void check_links(const World& world) {
  const auto models = world.models.size();
  const auto movers = world.movers.size();
  const auto known = [&](const auto& row) { return row.model < models; };
  bool good = std::all_of(world.walls.begin(), world.walls.end(), known);
  good &= std::all_of(world.magnets.begin(), world.magnets.end(), known);
  for (const Model& m : world.models)
    good &= (m.parent == kNone || m.parent < models) && (m.mover == kNone || m.mover < movers);
  for (const Mover& m : world.movers) {
    good &= m.model < models && std::all_of(m.body.begin(), m.body.end(), known);
    good &= std::all_of(m.magnets.begin(), m.magnets.end(), known);
  }
  good &= std::all_of(world.lights.begin(), world.lights.end(), known);
  good &= std::all_of(world.emitters.begin(), world.emitters.end(), known);
  good &= std::all_of(world.lamps.begin(), world.lamps.end(), known);
  good &= std::all_of(world.heat_sources.begin(), world.heat_sources.end(), known);
  good &= std::all_of(world.fiducials.begin(), world.fiducials.end(), known);
  good &= std::all_of(world.floor_holes.begin(), world.floor_holes.end(), known);
  good &= std::all_of(world.mesh_models.begin(), world.mesh_models.end(), known);
  good &= std::all_of(world.reflectances.begin(), world.reflectances.end(), known);
  for (const MeshModel& row : world.mesh_models) good &= row.mesh < world.meshes.size();
  for (const MeshMaterials& row : world.mesh_materials) good &= row.mesh < world.meshes.size();
  for (const MeshTextures& row : world.mesh_textures) {
    good &= row.mesh < world.meshes.size();
    for (const TextureUse& use : row.materials)
      good &= use.texture == kNoTexture || use.texture < world.textures.size();
  }
  if (!good) refuse("a row refers to a row that does not exist");
}

/// @param materials per mesh: their number
bool are_textures_good(const World& world, std::vector<std::size_t> materials) {
  bool good = true;
  std::size_t texels = 0;
  for (const Texture& texture : world.textures) {
    const std::size_t own = std::size_t{texture.width} * texture.height;
    texels += own, good &= texture.rgb.size() == 3 * own;
  }
  for (const MeshTextures& row : world.mesh_textures)
    good &= row.materials.size() == std::exchange(materials[row.mesh], 0) && !row.materials.empty() &&
            row.corners.size() == world.meshes[row.mesh].corners.size();
  return good && texels <= kMostTexels;
}

// Checks the invariants of rows in world.h, because users of a world do not check them again. World files are checked
// when they are read, but a recording's world is untrusted.
void check_rows(const World& world) {
  bool good = is_within(world);
  for (const Path& path : world.paths) good &= !path.pieces.empty();
  for (const Light& light : world.lights) good &= !light.phases.empty();
  for (const Shape& shape : world.shapes)
    good &=
        shape.outline.size() <= kMostShapeSides && shape.size.x >= 0.0 && shape.size.y >= 0.0 && shape.size.z >= 0.0;
  for (const FloorHole& hole : world.floor_holes) good &= hole.outline.size() >= 3;
  for (const Mesh& mesh : world.meshes) {
    good &= mesh.corners.size() % 3 == 0 && mesh.corners.size() / 3 <= kMostTriangles;
    for (const std::uint32_t corner : mesh.corners) good &= corner < mesh.vertices.size();
  }
  std::vector<std::size_t> materials(world.meshes.size(), 0);  // per mesh: their number; 0: none
  for (const MeshMaterials& row : world.mesh_materials) {
    good &= materials[row.mesh] == 0 && !row.materials.empty() &&
            row.triangles.size() == world.meshes[row.mesh].corners.size() / 3;
    for (const std::uint32_t material : row.triangles)
      good &= material < row.materials.size() || material == kNoMaterial;
    for (const Material& material : row.materials)
      for (int k = 0; k < 3; ++k) good &= material.color[k] >= 0.0 && material.color[k] <= 1.0;
    materials[row.mesh] = row.materials.size();
  }
  good &= are_textures_good(world, std::move(materials));
  good &= world.terrain.size() <= 1 && world.daylight.size() <= 1 && world.ground.size() <= 1;
  for (const BeamTable& table : world.beam_tables) good &= !table.rows.empty() && table.rows.size() <= kMostTableBeams;
  for (const Terrain& terrain : world.terrain)
    good &= std::min(terrain.columns, terrain.rows) >= 2 && std::max(terrain.columns, terrain.rows) <= kMostSide &&
            terrain.heights.size() == std::size_t{terrain.columns} * terrain.rows;
  good &= world.marking_heights.size() <= world.lane_markings.size();
  if (!good) refuse("a row breaks the rules of its table");
}

}  // namespace

std::vector<std::uint8_t> snapshot(const World& world) {
  std::vector<std::uint8_t> bytes;
  base::ByteWriter out(bytes);
  out.put(kMagic);
  out.put(version_of(world));
  // The spelling of the world file's path is not part of the world.
  RowWriter{out, RowFields::all, std::filesystem::path(world.file).parent_path().lexically_normal()}.put(world);
  bytes.resize(bytes.size() - missing_bytes(version_of(world)));
  return bytes;
}

World from_snapshot(const std::vector<std::uint8_t>& bytes) {
  constexpr std::size_t kVersionAt = sizeof kMagic;
  std::vector<std::uint8_t> whole = bytes;
  if (bytes.size() > kVersionAt && bytes[kVersionAt] >= kOldestVersion)
    whole.resize(bytes.size() + missing_bytes(bytes[kVersionAt]));
  base::ByteReader in(whole);
  if (in.get<std::uint32_t>() != kMagic) refuse("these bytes are not a world");
  const auto version = in.get<std::uint16_t>();
  if (version < kOldestVersion || version > kVersion)
    throw base::InputError(fmt::format("this world snapshot has version {}; this sensorfarm reads versions {} to {}",
                                       version, kOldestVersion, kVersion));

  World world;
  RowReader{in}.get(world);
  if (!in.good() || in.left() != 0) refuse("truncated, or longer than declared");
  check_links(world);
  check_rows(world);
  const std::uint64_t hash = world.hash;
  update_extent_and_hash(world);
  if (world.hash != hash) refuse("its content does not match its stored hash");
  return world;
}

}  // namespace sf::world
