// Height fields in spatial scans: against every triangle in `long double`, and where 32 or 64 bits cannot decide.

#include <gtest/gtest.h>

#include <hwy/highway.h>
#include <rapidcheck/gtest.h>
#include <algorithm>

#include "tests/scene/meshes.h"

namespace sf::scene {
namespace {

using base::QualityFlag;

SceneView over(const HeightField& field, const RigidTransform& X_WF = {}) { return {{}, false, {&field, X_WF}}; }

std::size_t echoes(const SpatialScan& scan, double range_max) {
  return static_cast<std::size_t>(std::ranges::count_if(scan.ranges, [&](double r) { return r < range_max; }));
}

/// Every bounding plane is above, or below, all points of its block.
TEST(HeightField, PlanesBoundTheirBlocks) {
  const HeightField field = waves(38, 21, 3.0, 1);
  for (std::int32_t level = 1; level <= field.levels; ++level)
    for (std::int32_t j = 0; j < field.rows; ++j)
      for (std::int32_t i = 0; i < field.columns; ++i) {
        const std::int32_t x = std::min(i, field.columns - 2) >> level, y = std::min(j, field.rows - 2) >> level;
        const std::int32_t row = y - (field.bias >> level) + field.bias / 2;
        for (const auto& [planes, sign] : {std::pair{&field.above, 1.0}, {&field.below, -1.0}}) {
          const BoundingPlane& plane = (*planes)[static_cast<std::size_t>(row * field.pitch + x)];
          const double bound = plane.height + double{field.slope_unit} * (plane.slope[0] * (i - (x << level)) +
                                                                          plane.slope[1] * (j - (y << level)));
          ASSERT_GE(bound, sign * field.heights[field.at(i, j)]) << level << " " << i << " " << j;
        }
      }
}

/// Smooth, rough and steep terrain, turned and moved, seen from above, below and outside.
TEST(SpatialTerrain, AgreesWithTheReference) {
  std::size_t flagged = 0, cast_count = 0, hit = 0;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const HeightField field =
        waves(20 + 7 * (seed % 3), 33, seed % 4 == 0 ? 40.0 : 0.4 * (seed % 4), seed, {1.0 + 0.5 * (seed % 2), 0.75});
    RigidTransform X_WF{base::rotation_of(0.0, 0.0, 0.4 * seed), {3.0, -2.0, 0.5}};
    if (seed % 5 == 0) X_WF.R = glm::dmat3(1.0);
    RigidTransform X_WS = Posed(seed, 1.0).X_WS;
    const glm::dvec3 place = seed % 3 == 0   ? glm::dvec3{-4.0, 10.0, 3.0}  // outside
                             : seed % 3 == 1 ? glm::dvec3{11.3, 12.1, 4.5}
                                             : glm::dvec3{11.3, 12.1, -4.5};  // below
    X_WS.p = base::transform(X_WF, place);
    const auto beams = rings(12, 64, -1.2, 1.2);
    const SceneView scene = over(field, X_WF);
    const SpatialScan scan = cast(X_WS, beams, 40.0, scene, seed % 2 ? 64 : 0);
    flagged += expect_bound(scan, X_WS, beams, 40.0, scene);
    cast_count += beams.size(), hit += echoes(scan, 40.0);
  }
  EXPECT_LT(flagged, cast_count / 1000);
  EXPECT_GT(hit, cast_count / 4);
}

/// Properties of any terrain and sensor: bounds, and bytes that do not depend on how beams are grouped.
RC_GTEST_PROP(SpatialTerrain, AnyScene, ()) {
  const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
  const HeightField field =
      waves(*rc::gen::inRange(2u, 40u), *rc::gen::inRange(2u, 40u), *rc::gen::element(0.0, 0.1, 3.0, 200.0), seed,
            {*rc::gen::element(0.01, 1.0, 30.0), 1.0});
  RigidTransform X_WS = Posed(seed + 1, 1.0).X_WS;
  const glm::dvec2 size = field.cell * glm::dvec2(field.columns - 1, field.rows - 1);
  X_WS.p *= glm::dvec3{size, field.highest - field.lowest + 1.0}, X_WS.p += glm::dvec3{0.5 * size, 0.0};
  const auto beams = rings(*rc::gen::inRange(1u, 9u), *rc::gen::inRange(1u, 40u), -1.5, 1.5);
  const SpatialScan scan = cast(X_WS, beams, 60.0, over(field));
  expect_bound(scan, X_WS, beams, 60.0, over(field));
  SpatialScan by_rows = cast(X_WS, beams, 60.0, over(field), 64);
  by_rows.uncertain = scan.uncertain;
  RC_ASSERT(scan == by_rows);
}

/// Where the horizon lets beams skip the field up to its border and beyond, they meet nothing: next to the border, and
/// in a narrow field.
TEST(SpatialTerrain, BeamsLeaveOverTheBorder) {
  const auto beams = rings(12, 60, -1.5, 1.5);
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const HeightField field = waves(2 + seed % 7, 13, 0.1, seed, {0.01, 1.0});
    RigidTransform X_WS = Posed(seed + 1, 1.0).X_WS;
    X_WS.p = {0.0061, 3.0 + 0.4 * static_cast<double>(seed), 2.2};
    const SpatialScan scan = cast(X_WS, beams, 60.0, over(field), seed % 2 ? 60 : 0);
    EXPECT_EQ(expect_bound(scan, X_WS, beams, 60.0, over(field)), 0u) << seed;
  }
}

/// Tiles whose beams all rise above the horizon are not searched, those next to it are.
TEST(SpatialTerrain, NarrowTilesAroundTheHorizon) {
  const HeightField field = waves(40, 40, 3.0, 4);
  std::size_t hit = 0, empty = 0;
  for (int k = 0; k < 12; ++k) {
    const RigidTransform X_WS{base::rotation_of(0.0, 0.0, 0.7 * k),
                              {20.5, 20.5, field.heights[field.at(20, 20)] + 2.0}};
    const auto beams = rings(8, 16, 0.08 * k - 0.2, 0.08 * k - 0.15, 0.1);
    const SpatialScan scan = cast(X_WS, beams, 60.0, over(field), 16);
    EXPECT_EQ(expect_bound(scan, X_WS, beams, 60.0, over(field)), 0u) << k;
    (echoes(scan, 60.0) > 0 ? hit : empty) += 1;
  }
  EXPECT_GT(hit, 0u);
  EXPECT_GT(empty, 0u);
}

/// The horizon is computed for the directions that a scan has: parts of a scan read what all of it does.
TEST(SpatialTerrain, PartsOfAScanAgreeWithTheWhole) {
  constexpr std::uint32_t kColumns = 45, kRings = 12;
  const auto beams = rings(kRings, kColumns, -1.5, 0.3, 2.0 * M_PI);
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const HeightField field = waves(90, 70, 2.0, seed);
    RigidTransform X_WS = Posed(seed, 0.3).X_WS;
    X_WS.p = {40.3, 30.4, field.heights[field.at(40, 30)] + 1.5 * seed};
    const SceneView scene = over(field);
    const SpatialScan whole = cast(X_WS, beams, 60.0, scene, kColumns);
    for (std::uint32_t width : {1u, 9u})
      for (std::uint32_t first = 0; first < kColumns; first += width) {
        std::vector<std::size_t> rows;
        std::vector<glm::dvec3> part;
        for (std::size_t i = 0; i < beams.size(); ++i)
          if (i % kColumns / width == first / width) rows.push_back(i), part.push_back(beams[i]);
        const SpatialScan scan = cast(X_WS, part, 60.0, scene, width);
        for (std::size_t k = 0; k < rows.size(); ++k) {
          ASSERT_EQ(scan.ranges[k], whole.ranges[rows[k]]) << seed << " " << width << " " << rows[k];
          ASSERT_EQ(scan.hits[k], whole.hits[rows[k]]);
          ASSERT_EQ(scan.quality[k], whole.quality[rows[k]]);
        }
      }
  }
}

/// No beam passes between cells or their triangles: at points of the grid, on edges, on diagonals. From above, none of
/// these meets the terrain at an outline, so none has a flag.
TEST(SpatialTerrain, IsWatertight) {
  for (const double far : {0.0, 1e7}) {
    const HeightField field = waves(24, 24, 0.3, 3);
    const RigidTransform X_WF{glm::dmat3(1.0), {far, -far, 0.1 * far}};
    const glm::dvec3 viewer = X_WF.p + glm::dvec3{11.3, 11.7, 30.0};
    std::vector<glm::dvec3> beams;
    for (std::int32_t j = 1; j < 22; ++j)
      for (std::int32_t i = 1; i < 22; ++i) {
        const auto point = [&](int x, int y) {
          return X_WF.p + glm::dvec3{i + x, j + y, field.heights[field.at(i + x, j + y)]};
        };
        for (const glm::dvec3& to : {point(1, 0), point(0, 1), point(1, 1)})
          for (const double part : {0.0, 0.25, 0.7})
            beams.push_back(glm::normalize(glm::mix(point(0, 0), to, part) - viewer));
      }
    const RigidTransform X_WS{glm::dmat3(1.0), viewer};
    const SpatialScan scan = cast(X_WS, beams, 60.0, over(field, X_WF));
    EXPECT_EQ(echoes(scan, 60.0), beams.size());
    EXPECT_EQ(std::ranges::count(scan.quality, QualityFlag::grazing), 0);
    EXPECT_GT(scan.uncertain, beams.size() / 2);
    EXPECT_EQ(expect_bound(scan, X_WS, beams, 60.0, over(field, X_WF)), 0u);
  }
}

/// Sensors in the planes of grid lines, of diagonals and of level ground, looking along these.
TEST(SpatialTerrain, InThePlanesOfLines) {
  const HeightField rough = waves(16, 16, 0.5, 4),
                    level = build_height_field(16, 16, {1.0, 1.0}, std::vector<float>(256));
  const auto beams = rings(9, 32, -0.4, 0.4, 2.0 * M_PI);
  std::vector<glm::dvec3> along;
  for (const glm::dvec3& d :
       {glm::dvec3{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {1, 1, 0}, {-1, -1, 0}, {1, -1, 0}})
    for (const double z : {0.0, -0.1, -0.5, 0.1}) along.push_back(glm::normalize(d + glm::dvec3{0, 0, z}));
  along.insert(along.end(), beams.begin(), beams.end());
  for (const HeightField* field : {&rough, &level})
    for (const glm::dvec3& at :
         {glm::dvec3{5.0, 5.0, 2.9}, {5.0, 7.0, 1.5}, {0.0, 4.0, 3.0}, {15.0, 15.0, 3.0}, {-2.0, 0.0, 2.0}}) {
      const RigidTransform X_WS{glm::dmat3(1.0), at};
      const SpatialScan scan = cast(X_WS, along, 30.0, over(*field));
      EXPECT_LT(expect_bound(scan, X_WS, along, 30.0, over(*field)), along.size() / 4);
    }
}

/// A beam along the border may meet the terrain or not: it is flagged, and its neighbours 1e-9 rad aside are not.
TEST(SpatialTerrain, FlagsItsBorder) {
  const HeightField field = build_height_field(5, 5, {1.0, 1.0}, std::vector<float>(25));
  std::vector<glm::dvec3> beams;
  for (const double aside : {0.0, -5e-9, 5e-9}) beams.push_back(glm::normalize(glm::dvec3{2.0, 2.0 + aside, -2.0}));
  const SpatialScan scan = cast({glm::dmat3(1.0), {1.5, 2.0, 2.0}}, beams, 20.0, over(field));
  EXPECT_EQ(scan.quality, (std::vector{QualityFlag::grazing, QualityFlag::none, QualityFlag::none}));
  EXPECT_NEAR(scan.ranges[1], std::sqrt(12.0), 1e-7);
  EXPECT_EQ(scan.ranges[2], 20.0);
}

/// A beam that touches a ridge may pass or not.
TEST(SpatialTerrain, FlagsRidges) {
  std::vector<float> heights(81);
  for (int y = 0; y < 9; ++y) heights[9 * y + 4] = 1.0f;
  const HeightField field = build_height_field(9, 9, {1.0, 1.0}, heights);
  std::vector<glm::dvec3> beams;
  for (const double up : {0.0, 1e-8, -1e-8}) beams.push_back(glm::normalize(glm::dvec3{1.0, 0.1, up}));
  const SpatialScan scan = cast({glm::dmat3(1.0), {1.5, 3.3, 1.0}}, beams, 20.0, over(field));
  EXPECT_EQ(scan.quality, (std::vector{QualityFlag::grazing, QualityFlag::none, QualityFlag::none}));
  EXPECT_EQ(scan.ranges[1], 20.0);
  EXPECT_NEAR(scan.ranges[2], 2.5 * std::sqrt(1.01), 1e-6);
}

/// A sensor on the surface flags every beam.
TEST(SpatialTerrain, OnTheSurface) {
  const HeightField field = build_height_field(5, 5, {1.0, 1.0}, std::vector<float>(25));
  const SpatialScan scan = cast({glm::dmat3(1.0), {1.3, 1.6, 0.0}}, {{0, 0, -1}, {0, 0, 1}}, 9.0, over(field));
  EXPECT_EQ(scan.quality, (std::vector{QualityFlag::grazing, QualityFlag::grazing}));
}

/// The nearest of terrain, bodies and floor wins, in any order and from either side of a wall.
TEST(SpatialTerrain, MeetsOtherSurfaces) {
  const HeightField field = waves(24, 24, 0.3, 6);
  Mesh boxes;
  for (int i = 0; i < 20; ++i) add_box(boxes, {i, 23 - i, -3.0}, {i + 0.4, 23.4 - i, 0.1 * i});
  const SurfaceTree tree = build_tree(boxes);
  const Instance instance{&tree, {}, true};
  const auto beams = rings(16, 96, -0.9, 0.4);
  for (const glm::dvec3& at : {glm::dvec3{11.2, 12.4, 4.0}, glm::dvec3{3.1, 4.1, -5.0}}) {
    const RigidTransform X_WS{glm::dmat3(1.0), at};
    const SceneView scene{{&instance, 1}, true, {&field, {}}};
    const SpatialScan scan = cast(X_WS, beams, 30.0, scene);
    EXPECT_LT(expect_bound(scan, X_WS, beams, 30.0, scene), beams.size() / 100);
    EXPECT_GT(std::ranges::count(scan.hits, base::kFloorHit), 100);
    EXPECT_GT(std::ranges::count(scan.hits, 0u), at.z > 0.0 ? 10 : -1);
  }
}

/// Bytes do not depend on the machine's vectors.
TEST(SpatialTerrain, EqualOnAllInstructionSets) {
  const HeightField field = waves(60, 50, 0.3, 7);
  const auto beams = rings(20, 100, -0.7, 0.3);
  const auto scan_with = [&](std::int64_t targets, glm::dvec3 at) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().DeInit();  // reselected by the next call
    SpatialScan scan = cast({Posed(5).X_WS.R, at}, beams, 50.0, over(field));
    scan.uncertain = 0;  // bounds depend on fused products
    return scan;
  };
  for (const glm::dvec3& at :
       {glm::dvec3{30.2, 24.3, 3.6}, glm::dvec3{-3.0, 20.0, 3.0}, glm::dvec3{30.2, 24.3, -4.0}}) {
    const SpatialScan best = scan_with(0, at);
    const std::int64_t all = hwy::SupportedTargets();
    for (std::int64_t left = all; left != 0; left &= left - 1) EXPECT_EQ(scan_with(left & -left, at), best);
    scan_with(0, at);
  }
}

/// 32 bits settle nearly all beams, or the scan would be slow.
TEST(SpatialTerrain, CertifiesNearlyAllBeams) {
  const HeightField field = waves(200, 200, 0.2, 2, {0.5, 0.5});
  const auto beams = rings(64, 256, -0.4, 0.1);
  EXPECT_LT(cast({glm::dmat3(1.0), {50.2, 49.7, 4.5}}, beams, 60.0, over(field)).uncertain, beams.size() / 100);
}

}  // namespace
}  // namespace sf::scene
