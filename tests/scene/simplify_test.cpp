// Simplified meshes: displacements, closed surfaces, and the choice of a level.

#include "scene/simplify.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "scene/rasterizer.h"
#include "scene/solids.h"

namespace sf::scene {
namespace {

/// A sphere of radius 1, of triangles between `rings` circles of latitude.
world::Mesh sphere(std::uint32_t rings) {
  world::Mesh mesh;
  const std::uint32_t columns = 2 * rings;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t k = 0; k < columns; ++k) {
      const double a = M_PI * i / rings, b = 2 * M_PI * k / columns;
      mesh.vertices.push_back({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t k = 0; k < columns; ++k) {
      const std::uint32_t a = i * columns + k, b = i * columns + (k + 1) % columns, c = a + columns, d = b + columns;
      if (i > 0) mesh.corners.insert(mesh.corners.end(), {a, c, b});
      if (i + 1 < rings) mesh.corners.insert(mesh.corners.end(), {b, c, d});
    }
  return mesh;
}

/// Each original vertex has a new one within the diagonal of a cell.
TEST(Simplify, DisplacesVerticesByLessThanADiagonal) {
  const world::Mesh mesh = sphere(60);
  for (const double cell : {0.5, 0.1, 0.02}) {
    const world::Mesh coarse = clustered(mesh, cell).mesh;
    EXPECT_LT(coarse.vertices.size(), mesh.vertices.size());
    for (std::size_t i = 0; i < mesh.vertices.size(); i += 7) {
      double nearest = HUGE_VAL;
      for (const glm::dvec3& p : coarse.vertices) nearest = std::min(nearest, glm::distance(p, mesh.vertices[i]));
      EXPECT_LE(nearest, std::sqrt(3.0) * cell);
    }
  }
}

/// Cells smaller than the distances of the vertices change nothing; one cell leaves nothing.
TEST(Simplify, ExtremeCells) {
  const world::Mesh mesh = sphere(8);
  EXPECT_EQ(clustered(mesh, 1e-6).mesh.corners.size(), mesh.corners.size());
  EXPECT_TRUE(clustered(mesh, 10.0).mesh.corners.empty());
}

/// Seen from its centre, a closed surface stays closed, and every range is off by at most the displacement.
TEST(Simplify, LevelsOfAClosedSurface) {
  const world::Mesh mesh = sphere(100);
  const std::vector<MeshLevel> levels = levels_of(mesh);
  ASSERT_GE(levels.size(), 3u);
  std::vector<glm::dvec3> beams;
  for (int i = 0; i < 2'000; ++i) {  // a spiral over the sphere
    const double z = (2.0 * i + 1.0) / 2'000 - 1.0, a = 2.4 * i, r = std::sqrt(1.0 - z * z);
    beams.push_back({r * std::cos(a), r * std::sin(a), z});
  }
  const BeamPattern pattern = make_pattern(beams, 0);
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const MeshLevel& level = levels[k];
    if (k > 0) {
      EXPECT_DOUBLE_EQ(level.displacement, 0.5 * levels[k - 1].displacement);
    }
    EXPECT_LE(level.tree.mesh.faces.size(), 0.7 * static_cast<double>(mesh.corners.size()) / 3.0);
    const Instance instance{&level.tree, {}, true, 0};
    std::vector<double> ranges(beams.size());
    std::vector<std::uint32_t> hits(beams.size());
    std::vector<base::QualityFlag> quality(beams.size());
    Rasterizer().scan({}, pattern, 5.0, {{&instance, 1}, false}, {ranges, hits, quality});
    for (const double range : ranges) ASSERT_NEAR(range, 1.0, level.displacement + 1e-3) << k;
  }
}

/// The coarsest level that is allowed; the exact mesh if none is.
TEST(Simplify, ChoosesTheCoarsestAllowedLevel) {
  const std::vector<MeshLevel> levels = levels_of(sphere(100));
  const SurfaceTree exact;
  EXPECT_EQ(&level_for(levels, 100.0, exact), &levels[0].tree);
  EXPECT_EQ(&level_for(levels, levels[1].displacement, exact), &levels[1].tree);
  EXPECT_EQ(&level_for(levels, 0.999 * levels.back().displacement, exact), &exact);
  EXPECT_EQ(&level_for(levels, -1.0, exact), &exact);
  EXPECT_EQ(&level_for({}, 1.0, exact), &exact);
}

}  // namespace
}  // namespace sf::scene
