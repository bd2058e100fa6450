// Beams at vertices and along edges of closed surfaces, against CGAL's exact constructions: a second oracle, whose
// decisions have no rounding at all.

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "tests/scene/meshes.h"

namespace sf::scene {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Triangles = std::vector<Exact::Triangle_3>;
using ExactTree = CGAL::AABB_tree<CGAL::AABB_traits<Exact, CGAL::AABB_triangle_primitive<Exact, Triangles::iterator>>>;

Exact::Point_3 exact(glm::dvec3 p) { return {p.x, p.y, p.z}; }

Triangles triangles_of(const Mesh& mesh) {
  Triangles triangles;
  for (const Face& face : mesh.faces) {
    const auto corner = [&](std::size_t k) { return exact(mesh.vertices[face[k]]); };
    triangles.emplace_back(corner(0), corner(1), corner(2));
    if (corners_of(face) == 4) triangles.emplace_back(corner(0), corner(2), corner(3));
  }
  return triangles;
}

/// Range to the nearest triangle along a beam; infinity if there is none.
double exact_range(const ExactTree& tree, glm::dvec3 from, glm::dvec3 d) {
  const Exact::Ray_3 ray(exact(from), Exact::Vector_3(d.x, d.y, d.z));
  const auto hit = tree.first_intersection(ray);
  if (!hit) return HUGE_VAL;
  const auto range = [&](const Exact::Point_3& p) {
    return std::sqrt(CGAL::to_double(CGAL::squared_distance(ray.source(), p)));
  };
  if (const auto* point = boost::get<Exact::Point_3>(&hit->first)) return range(*point);
  const auto& along = boost::get<Exact::Segment_3>(hit->first);  // in the plane of a triangle
  return std::min(range(along.source()), range(along.target()));
}

/// Beams at vertices, at the middles of edges and of faces, and anywhere.
std::vector<glm::dvec3> aimed(const Mesh& mesh, glm::dvec3 eye, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> beams;
  const auto aim = [&](glm::dvec3 p) { beams.push_back(glm::normalize(p - eye)); };
  for (const glm::dvec3& p : mesh.vertices) aim(p);
  for (const Face& face : mesh.faces) {
    const auto corner = [&](std::size_t k) { return mesh.vertices[face[k]]; };
    for (std::size_t k = 0; k < 3; ++k) aim(0.5 * (corner(k) + corner((k + 1) % 3)));
    aim((corner(0) + corner(1) + corner(2)) / 3.0);
    beams.push_back(glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)}));
  }
  return beams;
}

TEST(CgalOracle, SharedVerticesAndEdges) {
  Mesh boxes;
  add_box(boxes, {-3, -2, -1}, {3, 2, 1});
  add_box(boxes, {-1, -1, -0.5}, {-0.5, 1, 0.5});  // inside the first
  std::size_t wrong = 0, flagged = 0, count = 0;
  for (const Mesh& mesh : {boxes, sphere({0.1, 0.2, 0.3}, 2.0, 8, 16), hills(8, 3)}) {
    Triangles triangles = triangles_of(mesh);
    const ExactTree exact_tree(triangles.begin(), triangles.end());
    const SurfaceTree tree = build_tree(mesh);
    const Instance instance{&tree, {}, true};
    for (const glm::dvec3& eye : {glm::dvec3{0.3, 0.1, -0.2}, glm::dvec3{1.0, 0.5, 0.25}, glm::dvec3{-6.0, 3.0, 2.0}}) {
      const std::vector<glm::dvec3> beams = aimed(mesh, eye, 7);
      const SpatialScan scan = cast({glm::dmat3(1.0), eye}, beams, 50.0, {{&instance, 1}, false});
      for (std::size_t i = 0; i < beams.size(); ++i, ++count) {
        flagged += scan.quality[i] != base::QualityFlag::none;
        const double range = std::min(50.0, exact_range(exact_tree, eye, beams[i]));
        if (scan.quality[i] == base::QualityFlag::none) wrong += !(std::abs(scan.ranges[i] - range) <= kRangeError);
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(count, 3'000u);
  EXPECT_LT(flagged, count / 5) << "only silhouettes";
}

}  // namespace
}  // namespace sf::scene
