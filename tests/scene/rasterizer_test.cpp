// Spatial scans against every face in `long double`, and at the cases where 32 or 64 bits cannot decide.

#include "scene/rasterizer.h"

#include <gtest/gtest.h>

#include <hwy/highway.h>
#include <rapidcheck/gtest.h>
#include <algorithm>

#include "tests/scene/meshes.h"

namespace sf::scene {
namespace {

using base::QualityFlag;

Instance still(const SurfaceTree& tree) { return {&tree, {}, true}; }

/// Faces of all sizes in all directions, at any pose: every range is within its bound, and few beams graze.
TEST(SpatialRasterizer, AgreesWithTheReference) {
  std::size_t flagged = 0, beams_cast = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const SurfaceTree tree = build_tree(seed % 2 ? soup(400, 20.0, seed) : hills(20, seed));
    const Instance instance = still(tree);
    const auto beams = rings(16, 64, -0.7, 0.7);
    const RigidTransform X_WS = Posed(seed, 3.0).X_WS;
    const SceneView scene{{&instance, 1}, seed % 3 == 0};
    flagged += expect_bound(cast(X_WS, beams, 30.0, scene, 64), X_WS, beams, 30.0, scene);
    beams_cast += beams.size();
  }
  EXPECT_LT(flagged, beams_cast / 1000);
}

/// Properties of random scenes: bounds, and bytes that do not depend on how beams are grouped.
RC_GTEST_PROP(SpatialRasterizer, AnyScene, ()) {
  const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
  const SurfaceTree tree = build_tree(soup(*rc::gen::inRange(1, 80), *rc::gen::element(0.5, 5.0, 50.0), seed));
  const Instance instance = still(tree);
  const SceneView scene{{&instance, 1}, *rc::gen::arbitrary<bool>()};
  const RigidTransform X_WS = Posed(seed + 1, 4.0).X_WS;
  const auto beams = rings(*rc::gen::inRange(1u, 9u), *rc::gen::inRange(1u, 40u), -1.5, 1.5);
  const SpatialScan scan = cast(X_WS, beams, 40.0, scene);
  expect_bound(scan, X_WS, beams, 40.0, scene);
  SpatialScan by_rows = cast(X_WS, beams, 40.0, scene, 64);
  by_rows.uncertain = scan.uncertain;
  RC_ASSERT(scan == by_rows);
}

/// No beam passes through a closed surface where faces meet: at vertices, along edges.
TEST(SpatialRasterizer, IsWatertight) {
  for (const auto& [at, rows, columns] :
       {std::tuple(glm::dvec3{}, 12u, 17u), std::tuple(glm::dvec3{0.3, -0.2, 0.1}, 12u, 17u),
        std::tuple(glm::dvec3{1e7, -1e7, 10.0}, 12u, 17u),
        std::tuple(glm::dvec3{0.3, -0.2, 0.1}, 3u, 4u)}) {  // one leaf, which is drawn in the sensor's frame
    Mesh mesh = sphere(at, 5.0, rows, columns);
    const glm::dvec3 viewer = at + glm::dvec3{0.4, 0.3, -0.2};
    std::vector<glm::dvec3> beams;
    for (const glm::dvec3& vertex : mesh.vertices) beams.push_back(glm::normalize(vertex - viewer));
    for (const Face& face : mesh.faces)
      for (std::uint32_t k = 0; k < 3; ++k)
        for (const double part : {0.25, 0.5, 0.9})
          beams.push_back(
              glm::normalize(glm::mix(mesh.vertices[face[k]], mesh.vertices[face[(k + 1) % 3]], part) - viewer));
    const SurfaceTree tree = build_tree(mesh);
    const Instance instance = still(tree);
    const SpatialScan scan = cast({glm::dmat3(1.0), viewer}, beams, 20.0, {{&instance, 1}, false});
    EXPECT_EQ(std::ranges::count(scan.hits, kNoFace), 0);
    EXPECT_GT(scan.uncertain, beams.size() / 2);
    EXPECT_EQ(std::ranges::count(scan.quality, QualityFlag::grazing), 0) << "edges are shared";
  }
}

/// A beam along the outline of a body may pass or not: it is flagged, and its neighbours 1e-9 rad aside are not.
TEST(SpatialRasterizer, FlagsOutlines) {
  Mesh mesh;
  add_box(mesh, {5.0, -1.0, -1.0}, {6.0, 1.0, 1.0});
  const SurfaceTree tree = build_tree(mesh);
  const Instance instance = still(tree);
  std::vector<glm::dvec3> beams;
  for (const double aside : {0.0, -5e-9, 5e-9}) beams.push_back(glm::normalize(glm::dvec3{5.0, 1.0 + aside, 0.3}));
  const SpatialScan scan = cast({}, beams, 20.0, {{&instance, 1}, false});
  EXPECT_EQ(scan.quality[0], QualityFlag::grazing);
  EXPECT_EQ(scan.quality[1], QualityFlag::none);
  EXPECT_EQ(scan.quality[2], QualityFlag::none);
  EXPECT_NEAR(scan.ranges[1], glm::length(glm::dvec3{5.0, 1.0, 0.3}), 1e-7);
  EXPECT_EQ(scan.ranges[2], 20.0);
}

/// The rounding of coordinates does not grow with the distance from the origin, only that of the stored values.
TEST(SpatialRasterizer, IsAsAccurateFarFromTheOrigin) {
  for (const double far : {1e4, 1e7, 1e9}) {
    Mesh mesh = soup(200, 20.0, 5);
    move(mesh, {far, -far, 0.1 * far});
    const SurfaceTree tree = build_tree(mesh);
    const Instance instance = still(tree);
    const SceneView scene{{&instance, 1}, false};
    RigidTransform X_WS = Posed(9, 2.0).X_WS;
    X_WS.p += glm::dvec3{far, -far, 0.1 * far};
    const auto beams = rings(16, 64, -0.7, 0.7);
    const SpatialScan scan = cast(X_WS, beams, 40.0, scene);
    EXPECT_LT(expect_bound(scan, X_WS, beams, 40.0, scene), beams.size() / 100);
    EXPECT_GT(std::ranges::count_if(scan.ranges, [](double r) { return r < 40.0; }), 100);
  }
}

/// Nor does it for moved bodies: their distance from the sensor is computed before it is rotated.
TEST(SpatialRasterizer, MovedBodiesFarFromTheOrigin) {
  const glm::dvec3 far{1e7, -1e7, 1e6};
  Mesh box;
  add_box(box, {-0.5, -0.3, 0.0}, {0.5, 0.3, 1.2});
  const SurfaceTree body = build_tree(box);
  std::vector<Instance> instances;
  for (int i = 0; i < 40; ++i) {
    RigidTransform X = Posed(200 + i, 8.0).X_WS;
    X.p += far;
    instances.push_back({&body, X, false});
  }
  RigidTransform X_WS = Posed(6, 1.0).X_WS;
  X_WS.p += far;
  const auto beams = rings(32, 256, -0.9, 0.9);
  const SpatialScan scan = cast(X_WS, beams, 25.0, {instances, false});
  EXPECT_LT(expect_bound(scan, X_WS, beams, 25.0, {instances, false}), beams.size() / 500);
  EXPECT_GT(std::ranges::count_if(scan.ranges, [](double r) { return r < 25.0; }), 500);
}

/// Sensors in the planes of faces, looking along the axes: every beam that is not flagged is right.
TEST(SpatialRasterizer, InThePlanesOfFaces) {
  Mesh mesh;
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y)
      if (x != 0 || y != 0)
        add_box(mesh, {4.0 * x - 1.0, 4.0 * y - 1.0, 0.0}, {4.0 * x + 1.0, 4.0 * y + 1.0, 1.0 + std::abs(x + y) % 2});
  const SurfaceTree tree = build_tree(mesh);
  const Instance instance = still(tree);
  const SceneView scene{{&instance, 1}, false};
  const auto beams = rings(9, 360, -0.2, 0.2);
  for (const glm::dvec3& at : {glm::dvec3{1.0, 1.0, 0.5}, glm::dvec3{0.0, 0.0, 1.0}, glm::dvec3{3.0, -2.0, 2.0}}) {
    const RigidTransform X_WS{glm::dmat3(1.0), at};
    EXPECT_LT(expect_bound(cast(X_WS, beams, 30.0, scene), X_WS, beams, 30.0, scene), beams.size() / 3);
  }
}

/// A sensor on a face flags every beam, since any of them may touch the face.
TEST(SpatialRasterizer, OnAFace) {
  Mesh mesh;
  mesh.add(std::array<glm::dvec3, 3>{glm::dvec3{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, 0);
  const SurfaceTree tree = build_tree(mesh);
  const Instance instance = still(tree);
  const SpatialScan scan = cast({}, {{0, 0, -1}, {1, 0, 0}}, 10.0, {{&instance, 1}, false});
  EXPECT_EQ(scan.quality, (std::vector{QualityFlag::grazing, QualityFlag::grazing}));
}

/// Patterns that do not fill a vector, that surround the sensor, or point at the poles.
TEST(SpatialRasterizer, AnyPattern) {
  const SurfaceTree tree = build_tree(sphere({0.1, 0.2, 0.3}, 4.0, 30, 40));
  const Instance instance = still(tree);
  const SceneView scene{{&instance, 1}, true};
  for (const auto& beams : {rings(1, 1, 0.0, 0.0), rings(1, 3, 0.1, 0.1), rings(1, 16, 0.0, 0.0),
                            rings(17, 1, -1.57, 1.57), rings(32, 33, -1.5707, 1.5707), rings(3, 100, 1.4, 1.57),
                            std::vector<glm::dvec3>(40, {0, 0, -1}), rings(1, 2000, 0.2, 0.2)}) {
    const RigidTransform X_WS = Posed(beams.size(), 0.5).X_WS;
    expect_bound(cast(X_WS, beams, 30.0, scene), X_WS, beams, 30.0, scene);
  }
}

/// Moved and rotated bodies, near to far and in any order; a body far away has no effect.
TEST(SpatialRasterizer, Instances) {
  Mesh box;
  add_box(box, {-0.5, -0.3, 0.0}, {0.5, 0.3, 1.2});
  const SurfaceTree body = build_tree(box), walls = build_tree(soup(60, 15.0, 3)), none = build_tree({});
  std::vector<Instance> instances{still(walls), still(none)};
  for (int i = 0; i < 40; ++i) {
    RigidTransform X = Posed(100 + i, 8.0).X_WS;
    if (i == 7) X.p = {1e6, 0.0, 0.0};
    instances.push_back({&body, X, false});
  }
  const auto beams = rings(32, 128, -0.6, 0.6);
  const RigidTransform X_WS = Posed(4, 1.0).X_WS;
  const SpatialScan scan = cast(X_WS, beams, 25.0, {instances, true});
  EXPECT_LT(expect_bound(scan, X_WS, beams, 25.0, {instances, true}), beams.size() / 500);
  std::ranges::reverse(instances);
  EXPECT_EQ(cast(X_WS, beams, 25.0, {instances, true}).ranges, scan.ranges);
}

/// The range of a plane is the height divided by the sine of the depression. A sensor in the plane flags every beam
/// except those that point up.
TEST(SpatialRasterizer, Floor) {
  const auto beams = rings(3, 8, -0.9, 0.9);
  const SpatialScan above = cast({glm::dmat3(1.0), {3.0, 4.0, 1.5}}, beams, 50.0, {{}, true});
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const double expected = beams[i].z < -1.5 / 50.0 ? -1.5 / beams[i].z : 50.0;
    EXPECT_NEAR(above.ranges[i], expected, kRangeError);
    EXPECT_EQ(above.hits[i], expected < 50.0 ? kFloorFace : kNoFace);
  }
  const SpatialScan below = cast({glm::dmat3(1.0), {3.0, 4.0, -1.5}}, beams, 50.0, {{}, true});
  EXPECT_NEAR(below.ranges.back(), 1.5 / beams.back().z, kRangeError) << "seen from below";
  const SpatialScan on = cast({glm::dmat3(1.0), {3.0, 4.0, 0.0}}, beams, 50.0, {{}, true});
  EXPECT_EQ(std::ranges::count(on.quality, QualityFlag::grazing), 16);
}

/// In 32 bits, near and up to 1 km away, along the ground and at all angles to faces: within the stated bound, with the
/// faces and flags of 64 bits, and only where these are accurate enough.
TEST(SpatialRasterizer, SingleRangesAreWithinTheirBound) {
  struct {
    Mesh mesh;
    double range, least_part;  ///< part of the beams that differ from those in 64 bits
    bool floor;
  } const cases[] = {{soup(300, 2.0, 1), 5.0, 0.2, false},    // a few metres: all but the flattest
                     {soup(300, 50.0, 2), 100.0, 0.2, true},  // with a floor
                     {hills(30, 3), 40.0, 0.2, false},
                     {soup(200, 400.0, 4), 1000.0, 0.0, true}};  // few are accurate enough
  for (const auto& [mesh, range, least_part, floor] : cases) {
    const SurfaceTree tree = build_tree(mesh);
    const Instance instance = still(tree);
    const auto beams = rings(24, 80, -1.2, 1.2);
    const RigidTransform X_WS = Posed(7, 0.4).X_WS;
    const SceneView scene{{&instance, 1}, floor};
    const SpatialScan exact = cast(X_WS, beams, range, scene), single = cast(X_WS, beams, range, scene, 0, true);
    expect_bound(single, X_WS, beams, range, scene, kSingleRangeError);
    EXPECT_EQ(single.hits, exact.hits);
    EXPECT_EQ(single.quality, exact.quality);
    std::size_t rounded = 0;
    for (std::size_t i = 0; i < beams.size(); ++i) rounded += single.ranges[i] != exact.ranges[i];
    EXPECT_GT(rounded, static_cast<std::size_t>(least_part * static_cast<double>(beams.size()))) << range;
  }
}

/// Bytes do not depend on the machine's vectors.
class SpatialInstructionSets : public testing::TestWithParam<bool> {};
TEST_P(SpatialInstructionSets, AreEqual) {
  const SurfaceTree tree = build_tree(soup(500, 10.0, 8));
  const Instance instance = still(tree);
  const auto beams = rings(20, 100, -0.7, 0.7);
  const RigidTransform X_WS = Posed(5).X_WS;
  const auto scan_with = [&](std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().DeInit();  // reselected by the next call
    SpatialScan scan = cast(X_WS, beams, 30.0, {{&instance, 1}, true}, 0, GetParam());
    scan.uncertain = 0;  // bounds depend on fused products
    return scan;
  };
  const SpatialScan best = scan_with(0);
  const std::int64_t all = hwy::SupportedTargets();
  for (std::int64_t left = all; left != 0; left &= left - 1) EXPECT_EQ(scan_with(left & -left), best);
  scan_with(0);
}

INSTANTIATE_TEST_SUITE_P(SpatialRasterizer, SpatialInstructionSets, testing::Bool(),
                         [](const auto& single) { return single.param ? "Single" : "Double"; });

/// 32 bits settle nearly all beams, or the scan would be slow.
TEST(SpatialRasterizer, CertifiesNearlyAllBeams) {
  const SurfaceTree tree = build_tree(hills(40, 2));
  const Instance instance = still(tree);
  const auto beams = rings(64, 256, -0.4, 0.1);
  EXPECT_LT(cast({}, beams, 30.0, {{&instance, 1}, false}).uncertain, beams.size() / 100);
}

/// A sink receives what the outputs of a scan contain, in the order of its tiles, and which vectors meet one face.
TEST(SpatialScan, SinksReceiveTheScan) {
  struct Sink final : TileSink {
    const ScanOutput* out = nullptr;
    std::size_t beams = 0, uniform = 0;
    std::vector<glm::vec3> normals;
    void take(const BeamTile& tile, const TileSurfaces& surfaces) override {
      for (std::uint32_t i = 0; i < tile.used * kWidth; ++i, ++beams) {
        const std::uint32_t at = tile.place[i];
        EXPECT_EQ(surfaces.ranges[i], out->ranges[at]);
        EXPECT_EQ(surfaces.hits[i], out->hits[at]);
        if (!out->materials.empty()) {
          EXPECT_EQ(surfaces.materials[i], out->materials[at]);
        }
        normals[at] = {surfaces.x[i], surfaces.y[i], surfaces.z[i]};
        const std::uint32_t first = i / kWidth * kWidth;
        if ((surfaces.uniform >> i / kWidth & 1) == 0) continue;
        EXPECT_EQ(surfaces.hits[i], surfaces.hits[first]);
        EXPECT_EQ(surfaces.x[i], surfaces.x[first]);
        ++uniform;
      }
    }
  } sink;
  Mesh some = soup(60, 20.0, 3);
  for (std::uint32_t k = 0; k < some.faces.size(); ++k) some.materials.push_back(k % 5);
  const SurfaceTree tree = build_tree(some);
  const Instance instance{&tree, {}, true};
  const HeightField field = waves(30, 30, 0.3, 1);
  const RigidTransform X_WF{glm::dmat3(1.0), {-15.0, -15.0, -4.0}}, X_WS = Posed(4, 1.0).X_WS;
  const auto beams = rings(20, 101, -1.0, 1.0);
  std::vector<double> ranges(beams.size());
  std::vector<std::uint32_t> hits(beams.size()), materials(beams.size());
  std::vector<base::QualityFlag> quality(beams.size());
  std::vector<glm::vec3> normals(beams.size());
  const ScanOutput out{
      .ranges = ranges, .hits = hits, .quality = quality, .normals = normals, .materials = materials, .sink = &sink};
  const SceneView scene{{&instance, 1}, false, {&field, X_WF}};
  const BeamPattern pattern = make_pattern(beams, 0);
  sink.out = &out, sink.normals.resize(beams.size());
  Rasterizer().scan(X_WS, pattern, 40.0, scene, out);
  EXPECT_EQ(sink.normals, normals);
  EXPECT_GE(sink.beams, beams.size());
  EXPECT_GT(sink.uniform, 16u);
  // Without other outputs of the surfaces.
  const ScanOutput few{.ranges = ranges, .hits = hits, .quality = quality, .sink = &sink};
  sink.out = &few, sink.normals.assign(beams.size(), {});
  Rasterizer().scan(X_WS, pattern, 40.0, scene, few);
  EXPECT_EQ(sink.normals, normals);
}

/// Images of all sizes, also those whose tiles are too wide and those with whole vectors: each pixel once, and the
/// bytes of the general pattern. Depths are ranges along the axis, and hits end with them.
TEST(SpatialRasterizer, ImagesHaveTheBytesOfAnyPattern) {
  const SurfaceTree tree = build_tree(soup(60, 8.0, 3)), box = build_tree(soup(5, 8.0, 4));
  const std::array instances{still(tree), Instance{&box, Posed(3, 2.0).X_WS, false}};
  const SceneView scene{instances, true};
  for (const auto& [width, height, focal] :
       {std::tuple(1u, 1u, 1.0), std::tuple(5u, 3u, 3.0), std::tuple(33u, 18u, 16.0), std::tuple(64u, 40u, 40.0),
        std::tuple(64u, 22u, 4.0)}) {
    std::vector<glm::dvec3> beams;
    for (std::uint32_t v = 0; v < height; ++v)
      for (std::uint32_t u = 0; u < width; ++u)
        beams.push_back(glm::normalize(glm::dvec3{focal, 0.5 * (width - 1.0) - u, 0.5 * (height - 1.0) - v}));
    const BeamPattern pattern = make_image_pattern(beams, width);
    const bool whole = width == 64 && focal > 30.0;
    EXPECT_EQ(std::ranges::all_of(pattern, [](const BeamTile& t) { return t.run == 4; }), whole) << width;
    const SpatialScan general = cast(Posed(5).X_WS, beams, 30.0, scene);
    SpatialScan image{std::vector<double>(beams.size(), -1.0), std::vector<std::uint32_t>(beams.size(), 0xDEADu),
                      std::vector<base::QualityFlag>(beams.size()), general.uncertain};
    Rasterizer().scan(Posed(5).X_WS, pattern, 30.0, scene, {image.ranges, image.hits, image.quality});
    EXPECT_EQ(image, general);
    const double depth_max = 30.0 * std::ranges::min(beams, {}, &glm::dvec3::x).x * (1.0 - 1e-12);
    ScanOutput depths{image.ranges, image.hits, image.quality};
    depths.depth_max = depth_max;
    Rasterizer().scan(Posed(5).X_WS, pattern, 30.0, scene, depths);
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const double depth = general.ranges[i] * beams[i].x;
      EXPECT_EQ(image.ranges[i], std::min(depth, depth_max));
      EXPECT_EQ(image.hits[i], depth < depth_max ? general.hits[i] : kNoFace);
    }
  }
}

/// Tiles that are filled at once, with full and partly full vectors, have the bytes of any pattern.
TEST(SpatialRasterizer, FilledTilesHaveTheBytesOfAnyPattern) {
  const SurfaceTree tree = build_tree(soup(60, 8.0, 3)), box = build_tree(soup(5, 8.0, 4));
  const std::array instances{still(tree), Instance{&box, Posed(3, 2.0).X_WS, false}};
  const SceneView scene{instances, true};
  BeamTile tile;
  for (const std::size_t count :
       {std::size_t{512}, std::size_t{1}, std::size_t{16}, std::size_t{49}, std::size_t{500}}) {
    std::vector<glm::dvec3> beams;  // a row, whose second half is a line below the first
    for (std::size_t i = 0; i < count; ++i)
      beams.push_back(glm::normalize(glm::dvec3{400.0, 128.0 - static_cast<double>(i % 256), i < 256 ? 30.0 : 29.0}));
    fill_tile(beams, 0.25, tile);
    EXPECT_EQ(tile.time, 0.25);
    const SpatialScan general = cast(Posed(5).X_WS, beams, 30.0, scene);
    SpatialScan filled{std::vector<double>(kTileBeams, -1.0), std::vector<std::uint32_t>(kTileBeams, 0xDEADu),
                       std::vector<base::QualityFlag>(kTileBeams), general.uncertain};
    Rasterizer().scan(Posed(5).X_WS, {&tile, 1}, 30.0, scene, {filled.ranges, filled.hits, filled.quality});
    filled.ranges.resize(count), filled.hits.resize(count), filled.quality.resize(count);
    EXPECT_EQ(filled, general) << count;
  }
}

}  // namespace
}  // namespace sf::scene
