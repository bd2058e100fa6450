#include "scene/device/device_rasterizer.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <utility>

#include "base/error.h"
#include "gpu/group_counts.h"
#include "scene/device/records.h"
#include "shaders/scene_tiles.comp.h"

namespace sf::scene {

namespace {

using gpu::Role;
using gpu::Texel;

// The kernel reads these structs as words.
static_assert(SF_TILE_BEAMS == kTileBeams && kTileVectors == 32 && kWidth == 16);
static_assert(sizeof(BeamTile) == 4 * SF_TILE_WORDS && offsetof(BeamTile, x) == 4 * SF_TILE_X);
static_assert(offsetof(BeamTile, dx) == 4 * SF_TILE_DX && offsetof(BeamTile, vectors) == 4 * SF_TILE_VECTORS);
static_assert(offsetof(BeamTile, tile) == 4 * SF_TILE_BOX && offsetof(BeamTile, tile.plane) == 4 * SF_TILE_PLANE);
static_assert(offsetof(BeamTile, tile.axis) == 4 * SF_TILE_AXIS && offsetof(BeamTile, longest) == 4 * SF_TILE_LONGEST);
static_assert(offsetof(BeamTile, used) == 4 * SF_TILE_USED);
static_assert(offsetof(DirectionBoxes<kTileVectors>, plane) == std::size_t{4} * 9 * 32);
static_assert(offsetof(DirectionBoxes<kTileVectors>, axis) == std::size_t{4} * 21 * 32);
static_assert(sizeof(TreeNode) == 4 * SF_NODE_WORDS && offsetof(TreeNode, child) == 4 * SF_NODE_CHILD);
static_assert(sizeof(TreeLeaf) == 4 * SF_LEAF_WORDS && offsetof(TreeLeaf, corner) == 0);
static_assert(offsetof(TreeLeaf, normal) == 4 * SF_LEAF_NORMAL && offsetof(TreeLeaf, extent) == 4 * SF_LEAF_EXTENT);
static_assert(offsetof(TreeLeaf, face) == 4 * SF_LEAF_FACE && offsetof(TreeLeaf, centre) == 4 * SF_LEAF_CENTRE);
static_assert(offsetof(TreeLeaf, radius) == 4 * SF_LEAF_RADIUS && offsetof(TreeLeaf, count) == 4 * SF_LEAF_COUNT);
static_assert(offsetof(TreeLeaf, body) == 4 * SF_LEAF_BODY && offsetof(TreeLeaf, outward) == 4 * SF_LEAF_OUTWARD);
static_assert(SF_SCENE_NO_FACE == kNoFace && SF_SCENE_FLOOR_FACE == kFloorFace);
static_assert(sizeof(CastBeam) == 16 && SF_BEAM_UNCERTAIN == CastBeam::kUncertain &&
              SF_BEAM_GRAZING == CastBeam::kGrazing);
static_assert(sizeof(ScenePlane) == sizeof(Plane));

// Mesa before 25.0 ends loops of software devices after 65 535 turns; an entry takes fewer than 26.
constexpr std::uint32_t kMostSoftwareEntries = 2'500, kMostEntries = 1'000'000;

gpu::Device& checked(gpu::Device& device) {
  if (device.is_host())
    throw base::DeviceError(
        "the caster 'vulkan' requires a Vulkan device, but the device is the host; choose the caster 'host' or 'auto', "
        "or a Vulkan device (Debian: mesa-vulkan-drivers)");
  return device;
}

template <class Record>
std::span<const Record> one(const Record& record) {
  return std::span(&record, 1);
}

}  // namespace

DeviceRasterizer::DeviceRasterizer(gpu::Device& device)
    : device_(checked(device)),
      nodes_(device, "nodes of surfaces", Texel::u32),
      leaves_(device, "leaves of surfaces", Texel::u32),
      planes_(device, "planes of surfaces", Texel::u32x4),
      tiles_(device, "tiles of beams", Texel::u32x4),
      jobs_(device, "tiles to cast", Texel::u32x4),
      scans_(device, "scans in space", Texel::u32x4),
      instances_(device, "instances of surfaces", Texel::u32x4),
      results_(device, "beams in space", Role::download, Texel::u32x4, kTileBeams),
      groups_(device, "groups of tiles", Role::upload, Texel::u32, 4),
      kernel_(device, "scans in space", scene_tiles_comp_spv,
              std::vector{device.info().software ? kMostSoftwareEntries : kMostEntries}) {
  gpu::write_counts({}, groups_);
}

void DeviceRasterizer::forget() {
  for (GrowingTable* table : {&nodes_, &leaves_, &planes_, &tiles_}) table->clear();
  trees_.clear(), patterns_.clear();
}

void DeviceRasterizer::begin() {
  for (GrowingTable* table : {&jobs_, &scans_, &instances_}) table->clear();
  tile_count_ = 0;
}

DeviceRasterizer::TreeRows DeviceRasterizer::rows_of(const SurfaceTree& tree) {
  if (const auto found = trees_.find(&tree); found != trees_.end()) return found->second;
  const TreeRows rows{static_cast<std::uint32_t>(nodes_.bytes() / sizeof(TreeNode)),
                      static_cast<std::uint32_t>(leaves_.bytes() / sizeof(TreeLeaf)),
                      static_cast<std::uint32_t>(planes_.bytes() / sizeof(Plane))};
  nodes_.add(std::span<const TreeNode>(tree.nodes));
  leaves_.add(std::span<const TreeLeaf>(tree.leaves));
  planes_.add(std::span<const Plane>(tree.planes));
  trees_.emplace(&tree, rows);
  return rows;
}

std::uint32_t DeviceRasterizer::first_tile_of(std::span<const BeamTile> pattern) {
  if (const auto found = patterns_.find(pattern.data()); found != patterns_.end()) return found->second;
  const auto first = static_cast<std::uint32_t>(tiles_.bytes() / sizeof(BeamTile));
  tiles_.add(pattern);
  patterns_.emplace(pattern.data(), first);
  return first;
}

void DeviceRasterizer::add_instance(const SceneMesh& mesh) {
  const TreeRows rows = rows_of(*mesh.tree);
  const glm::dmat3& R = mesh.X_FS.R;
  const glm::dvec3 p = mesh.X_FS.p, eye = p - mesh.tree->centre;
  const double room = 1e-6 * (mesh.tree->radius + glm::length(eye));
  const glm::vec4 eye32(glm::vec3(eye), static_cast<float>(room)),
      sphere(glm::vec3(mesh.centre), static_cast<float>(mesh.reach + 2.0 * room));
  instances_.add(one(SceneInstance{R[0].x,
                                   R[0].y,
                                   R[0].z,
                                   R[1].x,
                                   R[1].y,
                                   R[1].z,
                                   R[2].x,
                                   R[2].y,
                                   R[2].z,
                                   p.x,
                                   p.y,
                                   p.z,
                                   eye32.x,
                                   eye32.y,
                                   eye32.z,
                                   eye32.w,
                                   sphere.x,
                                   sphere.y,
                                   sphere.z,
                                   sphere.w,
                                   mesh.tree->root,
                                   rows.first_node,
                                   rows.first_leaf,
                                   rows.first_face,
                                   mesh.least_sine,
                                   mesh.first_face,
                                   0}));
}

std::optional<std::size_t> DeviceRasterizer::add(const RigidTransform& X_WS, std::span<const BeamTile> pattern,
                                                 double range_max, const SceneView& scene) try {
  if (scene.terrain.field != nullptr) return std::nullopt;
  list_meshes(X_WS, range_max, scene.instances, meshes_);
  std::ranges::sort(meshes_, {}, [](const SceneMesh& mesh) { return glm::length(mesh.centre) - mesh.reach; });
  const std::uint32_t first = first_tile_of(pattern);
  const auto first_instance = static_cast<std::uint32_t>(instances_.bytes() / sizeof(SceneInstance));
  for (const SceneMesh& mesh : meshes_) add_instance(mesh);
  const SeenPlane floor = floor_plane(X_WS, range_max);
  const auto scan = static_cast<std::uint32_t>(scans_.bytes() / sizeof(SceneScan));
  scans_.add(one(SceneScan{floor.normal.x, floor.normal.y, floor.normal.z, floor.height, floor.least_sine, range_max,
                           first_instance, static_cast<std::uint32_t>(meshes_.size()), scene.floor ? 1u : 0u, 0}));
  const std::size_t needed = std::size_t{kTileBeams} * (tile_count_ + pattern.size());
  if (needed > results_.texels()) {
    gpu::Buffer larger(device_, "beams in space", Role::download, Texel::u32x4,
                       std::max(needed, 2 * results_.texels()));
    if (!larger.fits_storage_buffer()) return std::nullopt;
    results_ = std::move(larger);
    bound_ = false;
  }
  for (std::uint32_t i = 0; i < pattern.size(); ++i)
    jobs_.add(one(SceneJob{first + i, scan, static_cast<std::uint32_t>(kTileBeams * (tile_count_ + i)), 0}));
  return std::exchange(tile_count_, tile_count_ + pattern.size());
} catch (const base::DeviceError&) {
  return std::nullopt;
}

bool DeviceRasterizer::prepare() {
  const gpu::GroupCounts groups = gpu::groups_for(tile_count_, 1);
  gpu::write_counts(groups, groups_);
  for (std::size_t i = tile_count_; i < groups.all(); ++i) jobs_.add(one(SceneJob{0, SF_SCENE_NO_VIEW, 0, 0}));
  bool again = !std::exchange(bound_, true);
  for (GrowingTable* table : {&nodes_, &leaves_, &planes_, &tiles_, &jobs_, &scans_, &instances_})
    again = table->take_replaced() || again;
  if (again)
    kernel_.bind({{"jobs", &jobs_.buffer()},
                  {"scans", &scans_.buffer()},
                  {"instances", &instances_.buffer()},
                  {"nodes", &nodes_.buffer()},
                  {"leaves", &leaves_.buffer()},
                  {"planes", &planes_.buffer()},
                  {"tiles", &tiles_.buffer()},
                  {"results", &results_}});
  return again;
}

void DeviceRasterizer::record(gpu::Batch& batch) const { batch.dispatch(kernel_, groups_, 0); }

void DeviceRasterizer::add_copies(gpu::Batch& batch) {
  batch.upload(groups_, 0, groups_.bytes());
  for (GrowingTable* table : {&nodes_, &leaves_, &planes_, &tiles_, &jobs_, &scans_, &instances_}) table->upload(batch);
  if (tile_count_ > 0) batch.download(results_, 0, tile_count_ * kTileBeams * sizeof(CastBeam));
}

std::span<const CastBeam> DeviceRasterizer::results(std::size_t first_tile, std::size_t tiles) {
  return results_.host<const CastBeam>().subspan(kTileBeams * first_tile, kTileBeams * tiles);
}

}  // namespace sf::scene
