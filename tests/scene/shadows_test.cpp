// Shadows against rays to the light through every face in `long double`, and their independence of groups.

#include "scene/shadows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>

#include "scene/reference_scan.h"
#include "tests/scene/meshes.h"

namespace sf::scene {
namespace {

struct Lit {
  std::vector<glm::dvec3> points;  ///< in the world
  std::vector<std::size_t> beams;  ///< that meet them
  std::vector<bool> dark;
};

/// Casts from the points that a scan meets, `group` at a time.
Lit cast_shadows(const RigidTransform& X_WS, const std::vector<glm::dvec3>& beams, const SceneView& scene,
                 glm::dvec3 light, std::uint32_t group) {
  const SpatialScan scan = cast(X_WS, beams, 60.0, scene);
  ShadowCaster caster;
  LightPoints points;
  std::array<std::uint32_t, kTileVectors> dark{};
  Lit lit;
  caster.begin(X_WS.p, light, scene);
  const auto flush = [&] {
    caster.cast(points, dark);
    for (std::uint32_t k = 0; k < points.count; ++k) lit.dark.push_back((dark[k / kWidth] >> k % kWidth & 1) != 0);
    points.count = 0;
  };
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (scan.hits[i] == base::kNoHit) continue;
    const glm::dvec3 p = X_WS.R * (scan.ranges[i] * beams[i]);
    lit.points.push_back(X_WS.p + p), lit.beams.push_back(i);
    points.add(glm::vec3(p));
    if (points.count == group) flush();
  }
  flush();
  return lit;
}

bool is_dark(glm::dvec3 p, glm::dvec3 light, const SceneView& scene) {
  return reference_scan({glm::dmat3(1.0), p + 3e-4 * light}, light, 1e4, {scene.instances, false, scene.terrain})
             .owner != base::kNoHit;
}

/// Scenes of two meshes, one of which is turned, in light from all directions.
TEST(Shadows, AgreeWithTheReference) {
  std::size_t wrong = 0, dark = 0, all = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Mesh box;
    add_box(box, {-1.0, -2.0, -0.5}, {1.0, 2.0, 3.0});
    const SurfaceTree some = build_tree(seed % 2 ? soup(300, 20.0, seed) : hills(16, seed)), other = build_tree(box);
    const Instance instances[] = {{&some, {}, true, 1}, {&other, Posed(seed, 8.0).X_WS, false, 2}};
    const SceneView scene{instances, true};
    const RigidTransform X_WS = Posed(seed + 9, 3.0).X_WS;
    const glm::dvec3 light = Posed(seed + 20, 1.0).X_WS.R[2];
    const Lit lit = cast_shadows(X_WS, rings(16, 64, -0.7, 0.7), scene, light, kTileBeams);
    for (std::size_t i = 0; i < lit.points.size(); ++i) wrong += lit.dark[i] != is_dark(lit.points[i], light, scene);
    dark += static_cast<std::size_t>(std::ranges::count(lit.dark, true)), all += lit.dark.size();
    // The division into groups changes nothing.
    EXPECT_EQ(cast_shadows(X_WS, rings(16, 64, -0.7, 0.7), scene, light, 37).dark, lit.dark);
  }
  EXPECT_LE(wrong, all / 2000) << "points within rounding of the border of a shadow, or of a surface";
  EXPECT_GT(dark, all / 5);
  EXPECT_LT(dark, 4 * all / 5);
}

/// Smooth and rough terrain, turned, with a box on it, in a low sun: points that face the sun.
TEST(Shadows, TerrainHidesTheSun) {
  std::size_t wrong = 0, dark = 0, all = 0;
  Mesh box;
  add_box(box, {-1.0, -1.0, -2.0}, {1.0, 1.0, 4.0});
  const SurfaceTree tree = build_tree(box);
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    const HeightField field = waves(24 + seed, 25, 0.3 * (seed % 4), seed, {1.0, 0.75});
    const RigidTransform X_WF{base::rotation_of(0.0, 0.0, 0.8 * seed), {3.0, -2.0, 0.5}};
    const Instance instance{&tree, {glm::dmat3(1.0), base::transform(X_WF, {16.0, 8.0, 0.0})}};
    const SceneView scene{{&instance, 1}, false, {&field, X_WF}};
    const RigidTransform X_WS{glm::dmat3(1.0), base::transform(X_WF, {11.3, 9.1, 6.0})};
    const glm::dvec3 light = toward(2.1 * seed, 0.1 + 0.08 * seed);
    const auto beams = rings(10, 48, -1.2, -0.05);
    const Lit lit = cast_shadows(X_WS, beams, scene, light, kTileBeams);
    for (std::size_t i = 0; i < lit.points.size(); ++i) {
      if (glm::dot(glm::dvec3(reference_scan(X_WS, beams[lit.beams[i]], 60.0, scene).normal), light) < 0.02) continue;
      wrong += lit.dark[i] != is_dark(lit.points[i], light, scene);
      dark += lit.dark[i], ++all;
    }
  }
  EXPECT_LE(wrong, all / 1000) << "points at the border of a shadow";
  EXPECT_GT(dark, all / 10);
  EXPECT_LT(dark, all / 2);
}

/// A ridge of 1 m, 1 m wide, in light along y: its shadow on flat ground ends where the light passes its top, and
/// neither the ridge's sunny side nor its top is hidden. Light along a line of the grid, and from outside of the field.
TEST(Shadows, OfARidge) {
  std::vector<float> heights(11 * 21, 0.0f);
  std::fill_n(heights.begin() + 11 * 15, 11, 1.0f);
  const HeightField field = build_height_field(11, 21, {1.0, 1.0}, heights);
  const auto dark_at = [&](glm::dvec3 p, glm::dvec3 light) {
    ShadowCaster caster;
    caster.begin({5.0, 0.0, 3.0}, glm::normalize(light), {{}, false, {&field, {}}});
    LightPoints points;
    points.add(glm::vec3(p - glm::dvec3{5.0, 0.0, 3.0}));
    std::array<std::uint32_t, kTileVectors> dark{};
    caster.cast(points, dark);
    return (dark[0] & 1) != 0;
  };
  const glm::dvec3 low{0.0, 1.0, 0.25};  // shadows of four times the height
  EXPECT_FALSE(dark_at({5.0, 10.99, 0.0}, low)) << "the shadow's end is at 11";
  EXPECT_TRUE(dark_at({5.0, 11.01, 0.0}, low));
  EXPECT_TRUE(dark_at({5.5, 13.9, 0.0}, low));
  EXPECT_FALSE(dark_at({5.0, 15.0, 1.0}, low)) << "the top";
  EXPECT_FALSE(dark_at({5.5, 15.5, 0.5}, low)) << "the sunny side";
  EXPECT_TRUE(dark_at({5.0, -2.0, -2.0}, {0.0, 1.0, 0.15})) << "from outside, below the ground";
  EXPECT_FALSE(dark_at({5.0, -2.0, 0.5}, low)) << "from outside, above the ridge";
  EXPECT_FALSE(dark_at({11.0, 12.0, 0.0}, {0.01, 1.0, 0.25})) << "leaves the field at its border";
  EXPECT_FALSE(dark_at({5.0, 12.0, 0.0}, {0.0, 0.0, 1.0})) << "light from above";
  EXPECT_TRUE(dark_at({5.0, 12.0, -0.1}, {0.0, 0.0, 1.0})) << "under the ground";
}

/// Light along an axis, in the plane of the sides of a box: these hide nothing, the top does.
TEST(Shadows, LightAlongAnAxis) {
  Mesh box;
  add_box(box, {-1.0, -1.0, 2.0}, {1.0, 1.0, 3.0});
  const SurfaceTree tree = build_tree(box);
  const Instance instance{&tree, {}, true};
  ShadowCaster caster;
  caster.begin({0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {{&instance, 1}});
  LightPoints points;
  for (const glm::vec3& p : {glm::vec3{0, 0, -1}, {0.99f, 0.99f, -1}, {1.01f, 0, -1}, {0, 0, 2}, {0, 0, 1.5f}})
    points.add(p);
  std::array<std::uint32_t, kTileVectors> dark{};
  caster.cast(points, dark);
  EXPECT_EQ(dark[0] & 31u, 0b10011u) << "below it, at its corner, beside it, on its top, inside";
}

}  // namespace
}  // namespace sf::scene
