#include "scene/join_triangles.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "scene/texture_map.h"

namespace sf::scene {

namespace {

constexpr double kLeastTurn = 1e-6;    // sine of the angle between two edges, so that rounding leaves a face convex
constexpr double kTextureRoom = 1e-6;  // 1 % of a texel of the largest textures
constexpr std::uint32_t kRemoved = 0xFFFFFFFFu;  // instead of a face's first corner

/// Two triangles with an edge in common.
struct TrianglePair {
  double edge;  ///< [m] square of its length
  std::uint32_t first, second;
  Face joined;
  FaceCoordinates coordinates{};
};

/// Returns whether a face of four corners is convex and keeps the invariant of Mesh.
bool is_flat_and_convex(const Mesh& mesh, const Face& face) {
  const Plane plane = plane_of(mesh, face);
  const auto at = [&](std::uint32_t k) { return mesh.vertices[face[k % 4]]; };
  double size = 0.0, coordinates = 0.0, distance = 0.0;
  for (std::uint32_t k = 0; k < 4; ++k) {
    const glm::dvec3 a = at(k + 1) - at(k), b = at(k + 2) - at(k + 1), p = glm::abs(at(k));
    const double length = glm::length(a);
    if (!(glm::dot(glm::cross(a, b), plane.normal) > kLeastTurn * length * glm::length(b))) return false;
    size = std::max(size, length), coordinates = std::max({coordinates, p.x, p.y, p.z});
    distance = std::max(distance, std::abs(glm::dot(plane.normal, at(k) - plane.point)));
  }
  return distance < 1e-13 * size + 4.0 * 0x1p-53 * coordinates;
}

bool alike(const std::vector<std::uint32_t>& rows, const TrianglePair& pair) {
  return rows.empty() || rows[pair.first] == rows[pair.second];
}

/// Sets the texture coordinates of a joined face. @return false if they are not affine over it
bool join_coordinates(const Mesh& mesh, const FaceEdge& e, const FaceEdge& other, TrianglePair& pair) {
  if (mesh.coordinates.empty()) return true;
  const FaceCoordinates &first = mesh.coordinates[e.face], &second = mesh.coordinates[other.face];
  const glm::vec2 a = first[e.k], b = first[(e.k + 1) % 3], c = first[(e.k + 2) % 3];
  glm::vec2 a_beside = second[other.k], b_beside = second[(other.k + 1) % 3];
  if (e.forward != other.forward) std::swap(a_beside, b_beside);
  pair.coordinates = {a, second[(other.k + 2) % 3], b};
  const auto at = [&](std::uint32_t k) { return mesh.vertices[pair.joined[k]]; };
  const glm::dvec2 c_beside = texture_map({at(0), at(1), at(2)}, pair.coordinates).at(at(3));
  const auto same = [](glm::dvec2 p, glm::dvec2 q) {
    return glm::distance(p, q) <= kTextureRoom * std::max(1.0, glm::length(p));
  };
  return same(a, a_beside) && same(b, b_beside) && same(c, c_beside);
}

/// Pairs of triangles that may be joined, those with the longest edges first.
std::vector<TrianglePair> flat_pairs(const Mesh& mesh) {
  std::vector<TrianglePair> pairs;
  for_each_edge(edges_of(mesh, equal_vertices(mesh)), [&](std::span<const FaceEdge> same) {
    if (same.size() != 2) return;
    const FaceEdge &e = same[0], &other = same[1];
    const Face &face = mesh.faces[e.face], &beside = mesh.faces[other.face];
    if (corners_of(face) != 3 || corners_of(beside) != 3) return;
    const std::uint32_t a = face[e.k], b = face[(e.k + 1) % 3], c = face[(e.k + 2) % 3];
    const glm::dvec3 along = mesh.vertices[b] - mesh.vertices[a];
    TrianglePair pair{glm::dot(along, along), e.face, other.face, {a, beside[(other.k + 2) % 3], b, c}};
    if (alike(mesh.owners, pair) && alike(mesh.materials, pair) && is_flat_and_convex(mesh, pair.joined) &&
        join_coordinates(mesh, e, other, pair))
      pairs.push_back(pair);
  });
  std::ranges::sort(pairs, {}, [](const TrianglePair& p) { return std::tuple(-p.edge, p.first, p.second); });
  return pairs;
}

}  // namespace

Mesh join_triangles(Mesh mesh) {
  std::vector<std::uint8_t> joined(mesh.faces.size(), 0);
  for (const TrianglePair& pair : flat_pairs(mesh)) {
    if (joined[pair.first] || joined[pair.second]) continue;
    joined[pair.first] = joined[pair.second] = 1;
    mesh.faces[pair.first] = pair.joined;
    if (!mesh.coordinates.empty()) mesh.coordinates[pair.first] = pair.coordinates;
    mesh.faces[pair.second][0] = kRemoved;
  }
  std::uint32_t kept = 0;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f][0] == kRemoved) continue;
    mesh.faces[kept] = mesh.faces[f];
    for (auto* rows : {&mesh.owners, &mesh.materials})
      if (!rows->empty()) (*rows)[kept] = (*rows)[f];
    if (!mesh.coordinates.empty()) mesh.coordinates[kept] = mesh.coordinates[f];
    ++kept;
  }
  mesh.faces.resize(kept);
  for (auto* rows : {&mesh.owners, &mesh.materials})
    if (!rows->empty()) rows->resize(kept);
  if (!mesh.coordinates.empty()) mesh.coordinates.resize(kept);
  return mesh;
}

}  // namespace sf::scene
