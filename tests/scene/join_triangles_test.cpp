// Which triangles are joined to faces of four corners, and that scans stay the same.

#include "scene/join_triangles.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/scene/meshes.h"

namespace sf::scene {
namespace {

/// Two triangles of the unit square in the plane z = 1.
Mesh square() { return {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, {{0, 1, 2, 2}, {0, 2, 3, 3}}, {7, 7}, {3, 3}}; }

std::size_t joined(const Mesh& mesh) { return join_triangles(mesh).faces.size(); }

TEST(JoinTriangles, Square) {
  const Mesh mesh = join_triangles(square());
  ASSERT_EQ(mesh.faces.size(), 1u);
  EXPECT_EQ(mesh.faces[0], (Face{2, 3, 0, 1}));  // around the square, without its diagonal
  EXPECT_EQ(mesh.owners, std::vector{7u});
  EXPECT_EQ(mesh.materials, std::vector{3u});
}

TEST(JoinTriangles, Cases) {
  Mesh mesh = square();
  std::swap(mesh.faces[1][0], mesh.faces[1][1]);
  EXPECT_EQ(joined(mesh), 1u) << "wound the other way";
  mesh = square();
  mesh.vertices.insert(mesh.vertices.end(), {mesh.vertices[0], mesh.vertices[2]});
  mesh.faces[1] = {4, 5, 3, 3};
  EXPECT_EQ(joined(mesh), 1u) << "each with its own vertices, as in STL files";
  for (glm::dvec3& v : mesh.vertices) v = v * 1e-3 + glm::dvec3(1e6);
  EXPECT_EQ(joined(mesh), 1u) << "small and far from the origin";
  mesh = square(), mesh.owners = {7, 8};
  EXPECT_EQ(joined(mesh), 2u) << "owners differ";
  mesh = square(), mesh.materials = {3, 4};
  EXPECT_EQ(joined(mesh), 2u) << "materials differ";
  mesh = square(), mesh.vertices[3].z += 1e-12;
  EXPECT_EQ(joined(mesh), 2u) << "not in one plane";
  mesh = square(), mesh.vertices[3] = {0.9, 0.2, 1};
  EXPECT_EQ(joined(mesh), 2u) << "on the same side of the edge";
  mesh = square(), mesh.vertices[1] = {-0.5, -0.8, 1};
  EXPECT_EQ(joined(mesh), 2u) << "not convex";
  mesh = square(), mesh.vertices[1] = {0, -1, 1};
  EXPECT_EQ(joined(mesh), 2u) << "a corner in the middle of a side";
  mesh = square(), mesh.faces[1] = mesh.faces[0];
  EXPECT_EQ(joined(mesh), 2u) << "the same triangle twice";
  mesh = square(), mesh.vertices.emplace_back(0.5, 0.5, 2.0), mesh.faces.push_back({0, 2, 4, 4});
  mesh.owners.push_back(7), mesh.materials.push_back(3);
  EXPECT_EQ(joined(mesh), 3u) << "three triangles at one edge";
  EXPECT_EQ(joined({}), 0u) << "nothing";
}

/// Triangles of one affine map of texture coordinates are joined, and keep it.
TEST(JoinTriangles, TextureCoordinates) {
  const glm::vec2 c[] = {{0, 1}, {3, 1}, {3, 0}, {0, 0}};  // of the corners
  const auto with = [&](const FaceCoordinates& first, const FaceCoordinates& second) {
    Mesh mesh = square();
    mesh.coordinates = {first, second};
    return join_triangles(mesh);
  };
  const FaceCoordinates first{c[0], c[1], c[2]}, second{c[0], c[2], c[3]};
  const Mesh whole = with(first, second);
  ASSERT_EQ(whole.faces.size(), 1u);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(whole.coordinates[0][k], c[whole.faces[0][k]]);
  Mesh turned = square();
  std::swap(turned.faces[1][0], turned.faces[1][1]), turned.coordinates = {first, {c[2], c[0], c[3]}};
  EXPECT_EQ(joined(turned), 1u) << "wound the other way";
  EXPECT_EQ(with(first, {c[0], c[2] + 5e-7f, c[3]}).faces.size(), 1u) << "rounding";
  EXPECT_EQ(with(first, {c[0] + 1.0f, c[2] + 1.0f, c[3] + 1.0f}).faces.size(), 2u) << "a seam, though a copy fits";
  EXPECT_EQ(with(first, {c[0], c[2] + 1e-4f, c[3]}).faces.size(), 2u) << "a corner with two coordinates";
  EXPECT_EQ(with(first, {c[0], c[2], c[3] + 1e-4f}).faces.size(), 2u) << "bent at the diagonal";
  EXPECT_EQ(with({}, {}).faces.size(), 1u) << "one colour";
}

TEST(JoinTriangles, LongestEdgeFirst) {
  // A strip of two squares, with an edge of length 1 between triangles of different squares.
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}},
            {{0, 1, 4, 4}, {1, 2, 5, 5}, {0, 4, 3, 3}, {1, 5, 4, 4}}};
  mesh = join_triangles(mesh);
  ASSERT_EQ(mesh.faces.size(), 2u);
  for (const Face& face : mesh.faces) EXPECT_EQ(corners_of(face), 4u);
}

TEST(JoinTriangles, ScansStayTheSame) {
  Mesh mesh = sphere({0.3, 0.1, 0.2}, 2.0, 12, 24);
  const std::size_t triangles = mesh.faces.size();
  const auto add = [&](const Mesh& more) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
    for (Face face : more.faces) {
      for (std::uint32_t& v : face) v += first;
      mesh.faces.push_back(face), mesh.owners.push_back(1);
    }
  };
  add(hills(20, 5));
  const SurfaceTree parts = build_tree(mesh), whole = build_tree(join_triangles(mesh));
  EXPECT_EQ(mesh.faces.size() - whole.mesh.faces.size(), (triangles - 48) / 2) << "all but the triangles at the poles";
  const Instance before{&parts, {}, true}, after{&whole, {}, true};
  const std::vector<glm::dvec3> beams = rings(32, 720, -1.2, 0.5);
  for (const glm::dvec3& p : {glm::dvec3{4.0, 1.0, 0.5}, {0.0, 0.0, 0.0}, {-3.0, -6.0, 1.0}}) {
    const RigidTransform X_WS{base::rotation_of(0.02, -0.03, 0.4), p};
    const SpatialScan a = cast(X_WS, beams, 50.0, {{&before, 1}}, 720), b = cast(X_WS, beams, 50.0, {{&after, 1}}, 720);
    EXPECT_EQ(a.hits, b.hits);
    for (std::size_t i = 0; i < beams.size(); ++i) EXPECT_NEAR(a.ranges[i], b.ranges[i], 2.0 * kRangeError);
  }
}

}  // namespace
}  // namespace sf::scene
