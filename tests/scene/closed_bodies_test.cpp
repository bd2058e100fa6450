// Which bodies count as closed, and that leaving out their back faces changes no range.

#include "scene/closed_bodies.h"

#include <gtest/gtest.h>

#include <hwy/highway.h>
#include <rapidcheck/gtest.h>
#include <algorithm>
#include <utility>

#include "tests/scene/meshes.h"

namespace sf::scene {
namespace {

Mesh box(glm::dvec3 low, glm::dvec3 high) {
  Mesh mesh;
  add_box(mesh, low, high);
  return mesh;
}

/// A tube around a closed curve. @param at (around the curve, around the tube), each in [0, 2 pi)
template <class Point>
Mesh tube(std::uint32_t rows, std::uint32_t columns, const Point& at) {
  Mesh mesh;
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t c = 0; c < columns; ++c)
      mesh.vertices.push_back(at(2.0 * M_PI * r / rows, 2.0 * M_PI * c / columns));
  for (std::uint32_t r = 0; r < rows; ++r)
    for (std::uint32_t c = 0; c < columns; ++c) {
      const auto row = [&](std::uint32_t i, std::uint32_t k) { return i % rows * columns + k % columns; };
      const std::uint32_t a = row(r, c), b = row(r + 1, c), d = row(r, c + 1), e = row(r + 1, c + 1);
      mesh.faces.push_back({a, b, e, e}), mesh.faces.push_back({a, e, d, d});
    }
  mesh.owners.assign(mesh.faces.size(), 0);
  return mesh;
}

Mesh torus(double radius, double thickness) {
  return tube(24, 12, [&](double u, double v) {
    const double r = radius + thickness * std::cos(v);
    return glm::dvec3{r * std::cos(u), r * std::sin(u), thickness * std::sin(v)};
  });
}

void add(Mesh& mesh, const Mesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (Face face : more.faces) {
    for (std::uint32_t& v : face) v += first;
    mesh.faces.push_back(face), mesh.owners.push_back(0);
  }
}

void turn(Face& face) {
  if (corners_of(face) == 3)
    std::swap(face[0], face[1]);
  else
    std::swap(face[1], face[3]);
}

/// Number of faces of closed bodies.
std::size_t closed(const Mesh& mesh) {
  const FaceSides sides = find_closed_bodies(mesh);
  return sides.outward.size() - static_cast<std::size_t>(std::ranges::count(sides.outward, 0));
}

/// Convex, curved, and with a hole; far from the origin; corners of faces that are stored once or face by face.
TEST(ClosedBodies, AreFound) {
  for (const glm::dvec3& at : {glm::dvec3{}, glm::dvec3{1e6, -1e6, 3.0}})
    for (Mesh mesh : {box({-1, -2, -3}, {1, 1, 1}), sphere({}, 2.0, 12, 17), torus(3.0, 1.0)}) {
      move(mesh, at);
      EXPECT_EQ(closed(mesh), mesh.faces.size());
    }
}

/// Faces are told apart by their orientation, whatever the order of their corners.
TEST(ClosedBodies, AreOrientedFaceByFace) {
  Mesh mesh = sphere({}, 2.0, 8, 9);
  for (std::size_t i = 0; i < mesh.faces.size(); i += 3) turn(mesh.faces[i]);
  const FaceSides sides = find_closed_bodies(mesh);
  for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
    const auto at = [&](int k) { return mesh.vertices[mesh.faces[i][k]]; };
    const double outward = glm::dot(glm::cross(at(1) - at(0), at(2) - at(0)), at(0) + at(1) + at(2));
    EXPECT_EQ(sides.outward[i], outward > 0.0 ? 1 : -1) << i;
  }
}

/// Two boxes side by side share no edges exactly once; each of two that touch at a corner is closed by itself.
TEST(ClosedBodies, AreSeparate) {
  Mesh corner = box({0, 0, 0}, {1, 1, 1});
  add(corner, box({1, 1, 1}, {2, 2, 2}));
  EXPECT_EQ(closed(corner), 12u);
  Mesh edge = box({0, 0, 0}, {1, 1, 1});
  add(edge, box({1, 1, 0}, {2, 2, 1}));
  EXPECT_EQ(closed(edge), 0u) << "an edge of four faces";
  Mesh through = box({0, 0, 0}, {1, 1, 1});
  add(through, box({0.5, 0.5, 0.5}, {2, 2, 2}));
  EXPECT_EQ(closed(through), 12u) << "bodies may pass through each other";
}

/// None of these has an inside everywhere on one side of its faces.
TEST(ClosedBodies, OthersAreOpen) {
  Mesh open = box({0, 0, 0}, {1, 1, 1});
  open.faces.pop_back(), open.owners.pop_back();
  EXPECT_EQ(closed(open), 0u) << "a face is missing";

  Mesh apart = sphere({}, 1.0, 6, 7);
  apart.vertices.push_back(apart.vertices[apart.faces[20][0]] + glm::dvec3{0.0, 0.0, 1e-15});
  apart.faces[20][0] = static_cast<std::uint32_t>(apart.vertices.size() - 1);
  EXPECT_EQ(closed(apart), 0u) << "a gap of one rounding";

  Mesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.faces = {{0, 1, 2, 2}, {0, 2, 1, 1}}, flat.owners = {0, 0};
  EXPECT_EQ(closed(flat), 0u) << "no volume";

  Mesh eight = sphere({}, 1.0, 12, 13);  // squeezed through itself: its upper half is inside out
  for (glm::dvec3& v : eight.vertices)
    if (v.z > 0.0) v.x = -v.x, v.y = -v.y;
  EXPECT_EQ(closed(eight), 0u) << "meets itself";

  const Mesh thick = tube(24, 12, [&](double u, double v) {  // thicker than the hole is wide
    const double r = 0.5 + std::cos(v);
    return glm::dvec3{r * std::cos(u), r * std::sin(u), std::sin(v)};
  });
  EXPECT_EQ(closed(thick), 0u) << "meets itself";

  const Mesh bottle = tube(32, 16, [&](double u, double v) {  // Klein's, by its figure of eight
    const double r = 3.0 + std::cos(0.5 * u) * std::sin(v) - std::sin(0.5 * u) * std::sin(2.0 * v);
    return glm::dvec3{r * std::cos(u), r * std::sin(u),
                      std::sin(0.5 * u) * std::sin(v) + std::cos(0.5 * u) * std::sin(2.0 * v)};
  });
  EXPECT_EQ(closed(bottle), 0u);
}

/// Sensors inside, outside and between closed bodies that may pass through each other: the ranges and faces of a scan
/// that draws all faces. A beam along an outline may have a flag only with fewer faces around it.
RC_GTEST_PROP(ClosedBodies, HideNothingElse, ()) {
  const auto seed = *rc::gen::inRange<std::uint64_t>(0, 1u << 30);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Mesh mesh;
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 at = 4.0 * glm::dvec3{unit(random), unit(random), unit(random)};
    Mesh body = i % 3 == 0 ? sphere({}, 1.5, 7, 9) : i % 3 == 1 ? torus(1.5, 0.5) : box({-1, -1, -1}, {1, 1, 2});
    for (Face& face : body.faces)
      if (unit(random) > 0.0) turn(face);
    move(body, at), add(mesh, body);
  }
  SurfaceTree tree = build_tree(mesh), all = tree;
  for (TreeLeaf& leaf : all.leaves) leaf.outward = 0;
  const Instance with = {&tree, {}, true}, without = {&all, {}, true};
  const RigidTransform X_WS = Posed(seed + 1, 5.0).X_WS;
  const auto beams = rings(4, 30, -1.4, 1.4);
  const SpatialScan scan = cast(X_WS, beams, 30.0, {{&with, 1}, false});
  const SpatialScan full = cast(X_WS, beams, 30.0, {{&without, 1}, false});
  RC_ASSERT(expect_bound(scan, X_WS, beams, 30.0, {{&with, 1}, false}) < 4u);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (scan.quality[i] != base::QualityFlag::none) continue;
    RC_ASSERT(scan.ranges[i] == full.ranges[i]);
  }
}

}  // namespace
}  // namespace sf::scene
