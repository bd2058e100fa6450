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
  caster.begin(X_WS.p, light, scene.instances);
  const auto flush = [&] {
    caster.cast(points, dark);
    for (std::uint32_t k = 0; k < points.count; ++k) lit.dark.push_back((dark[k / kWidth] >> k % kWidth & 1) != 0);
    points.count = 0;
  };
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (scan.hits[i] == base::kNoHit) continue;
    const glm::dvec3 p = X_WS.R * (scan.ranges[i] * beams[i]);
    lit.points.push_back(X_WS.p + p);
    points.add(glm::vec3(p));
    if (points.count == group) flush();
  }
  flush();
  return lit;
}

bool is_dark(glm::dvec3 p, glm::dvec3 light, const SceneView& scene) {
  return reference_scan({glm::dmat3(1.0), p + 3e-4 * light}, light, 1e4, {scene.instances}).owner != base::kNoHit;
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

/// Light along an axis, in the plane of the sides of a box: these hide nothing, the top does.
TEST(Shadows, LightAlongAnAxis) {
  Mesh box;
  add_box(box, {-1.0, -1.0, 2.0}, {1.0, 1.0, 3.0});
  const SurfaceTree tree = build_tree(box);
  const Instance instance{&tree, {}, true};
  ShadowCaster caster;
  caster.begin({0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {&instance, 1});
  LightPoints points;
  for (const glm::vec3& p : {glm::vec3{0, 0, -1}, {0.99f, 0.99f, -1}, {1.01f, 0, -1}, {0, 0, 2}, {0, 0, 1.5f}})
    points.add(p);
  std::array<std::uint32_t, kTileVectors> dark{};
  caster.cast(points, dark);
  EXPECT_EQ(dark[0] & 31u, 0b10011u) << "below it, at its corner, beside it, on its top, inside";
}

}  // namespace
}  // namespace sf::scene
