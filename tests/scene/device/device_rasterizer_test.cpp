// Scans on the device have the bytes of the host's, whatever the scene, and leave few beams to the host.

#include "scene/device/device_rasterizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "base/error.h"
#include "tests/scene/meshes.h"

namespace sf::scene {
namespace {

/// One scan.
struct Scene {
  std::vector<Instance> instances;
  bool floor = false;
  std::vector<glm::dvec3> beams;
  std::uint32_t row = 0;
  RigidTransform X_WS;
  double range_max = 30.0;

  SceneView view() const { return {instances, floor}; }
};

struct WithNormals {
  SpatialScan scan;
  std::vector<float> cosines;
  std::vector<glm::vec3> normals;
  bool operator==(const WithNormals&) const = default;
};

WithNormals finish(const Scene& scene, const BeamPattern& pattern, std::span<const CastBeam> cast, bool single) {
  const std::size_t n = scene.beams.size();
  WithNormals out{
      {std::vector<double>(n, -1.0), std::vector<std::uint32_t>(n, 0xDEADu), std::vector<base::QualityFlag>(n)},
      std::vector<float>(n, -2.0f),
      std::vector<glm::vec3>(n, glm::vec3(9.0f))};
  Rasterizer rasterizer;
  rasterizer.scan(scene.X_WS, pattern, scene.range_max, scene.view(),
                  {.ranges = out.scan.ranges,
                   .hits = out.scan.hits,
                   .quality = out.scan.quality,
                   .cosines = out.cosines,
                   .normals = out.normals,
                   .single = single},
                  cast);
  return out;
}

/// Casts scenes together. @return the number of beams that the host had to cast
std::size_t expect_host_bytes(DeviceRasterizer& device, gpu::Batch& batch, const std::vector<Scene>& scenes) {
  std::vector<BeamPattern> patterns;
  for (const Scene& scene : scenes) patterns.push_back(make_pattern(scene.beams, scene.row));
  device.forget(), device.begin();
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const auto at = device.add(scenes[i].X_WS, patterns[i], scenes[i].range_max, scenes[i].view());
    first.push_back(at.value());
  }
  if (device.prepare()) batch.begin(), device.record(batch), batch.end();
  device.add_copies(batch), batch.run();
  std::size_t uncertain = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const auto cast = device.results(first[i], patterns[i].size());
    for (std::size_t k = 0; k < cast.size(); ++k)
      uncertain += k % kTileBeams < kWidth * patterns[i][k / kTileBeams].used && (cast[k].flags & CastBeam::kUncertain);
    for (const bool single : {false, true})
      EXPECT_EQ(finish(scenes[i], patterns[i], cast, single), finish(scenes[i], patterns[i], {}, single))
          << "scene " << i;
  }
  return uncertain;
}

class SpatialKernel : public testing::Test {
 protected:
  gpu::Device device_;
  DeviceRasterizer rasterizer_{device_};
  gpu::Batch batch_{device_};
};

/// Faces of all sizes, hills, a floor, poses near and 10 000 km away; in one submission, then in others.
TEST_F(SpatialKernel, HasTheHostsBytes) {
  std::vector<SurfaceTree> trees;
  for (std::uint64_t seed = 1; seed <= 4; ++seed)
    trees.push_back(build_tree(seed % 2 ? soup(600, 20.0, seed) : hills(30, seed)));
  Mesh far = sphere({1e7, -1e7, 10.0}, 5.0, 12, 17);
  trees.push_back(build_tree(far));
  std::size_t uncertain = 0, beams = 0;
  for (std::uint64_t round = 0; round < 3; ++round) {
    std::vector<Scene> scenes;
    for (std::size_t i = 0; i < trees.size(); ++i) {
      Scene& scene = scenes.emplace_back();
      scene.instances = {{&trees[i], {}, true, 7}};
      scene.floor = (i + round) % 2 == 0;
      scene.beams = rings(16, 90, -0.8, 0.8);
      scene.row = 90;
      scene.X_WS = Posed(i + 10 * round, 3.0).X_WS;
      if (i == 4) scene.X_WS.p += glm::dvec3{1e7, -1e7, 10.0};
      beams += scene.beams.size();
    }
    uncertain += expect_host_bytes(rasterizer_, batch_, scenes);
  }
  EXPECT_LT(uncertain, beams / 100);
}

/// Many turned and displaced instances, as robots are.
TEST_F(SpatialKernel, CastsInstances) {
  Mesh box;
  add_box(box, {-0.3, -0.2, 0.0}, {0.3, 0.2, 0.5});
  for (std::uint32_t& owner : box.owners) owner = 0;
  const SurfaceTree tree = build_tree(box), walls = build_tree(soup(50, 10.0, 3));
  Scene scene{.instances = {{&walls, {}, true}}, .floor = true, .beams = rings(8, 128, -0.5, 0.3), .row = 128};
  for (std::uint64_t i = 0; i < 60; ++i) scene.instances.push_back({&tree, Posed(i, 15.0).X_WS, false, 5});
  scene.X_WS.p = {0.2, 0.1, 0.4};
  EXPECT_LT(expect_host_bytes(rasterizer_, batch_, {scene}), scene.beams.size() / 50);
}

/// Where 32 bits cannot decide: the sensor in planes of faces and of the floor, and beams at all vertices.
TEST_F(SpatialKernel, LeavesDoubtsToTheHost) {
  Mesh mesh;
  add_box(mesh, {2.0, -1.0, -1.0}, {3.0, 1.0, 1.0});
  add_box(mesh, {2.0, 1.0, -1.0}, {3.0, 2.0, 1.0});
  const SurfaceTree tree = build_tree(mesh);
  Scene scene{.instances = {{&tree, {}, true}}, .floor = true};
  for (const glm::dvec3& vertex : mesh.vertices)
    if (glm::length(vertex) > 0.0) scene.beams.push_back(glm::normalize(vertex));
  EXPECT_GT(expect_host_bytes(rasterizer_, batch_, {scene}), 0u);
}

/// One beam, one leaf, and nothing at all: the smallest tables.
TEST_F(SpatialKernel, CastsTheSmallestScans) {
  const SurfaceTree tree = build_tree(soup(1, 1.0, 5));
  EXPECT_EQ(expect_host_bytes(rasterizer_, batch_, {{.instances = {{&tree, {}, true}}, .beams = {{1.0, 0.0, 0.0}}}}),
            0u);
  EXPECT_EQ(expect_host_bytes(rasterizer_, batch_, {{.beams = {{1.0, 0.0, 0.0}}}}), 0u);
  EXPECT_EQ(expect_host_bytes(rasterizer_, batch_, {}), 0u);
}

/// Terrain has no kernel.
TEST_F(SpatialKernel, LeavesTerrainToTheHost) {
  const HeightField field;
  const BeamPattern pattern = make_pattern(std::vector<glm::dvec3>{{1.0, 0.0, 0.0}}, 0);
  EXPECT_FALSE(rasterizer_.add({}, pattern, 10.0, {.instances = {}, .terrain = {&field, {}}}).has_value());
}

TEST(SpatialKernels, NeedADevice) {
  gpu::Device host(std::string(gpu::kHostDevice));
  EXPECT_THROW(DeviceRasterizer{host}, base::DeviceError);
}

}  // namespace
}  // namespace sf::scene
