#include "world/meshes/triangles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "base/error.h"

namespace sf::world {

void TriangleBuilder::fail(const MeshPlace& at, std::string_view message) const {
  if (at.kind == std::string_view("line"))
    throw base::InputError(file_, static_cast<int>(at.number), std::string(message));
  throw base::InputError(file_, 0, fmt::format("{} {}: {}", at.kind, at.number, message));
}

void TriangleBuilder::fail(std::string_view message) const { throw base::InputError(file_, 0, std::string(message)); }

void TriangleBuilder::expect(std::uint64_t triangles) const {
  if (triangles > kMostTriangles)
    fail(fmt::format("has {} triangles; expected at most {}: simplify it, or divide it into several models", triangles,
                     kMostTriangles));
}

void TriangleBuilder::add_vertex(const glm::dvec3& p, const MeshPlace& at) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(p[axis]) <= kMostCoordinate))
      fail(at, fmt::format("the coordinate {:g} is not a number within {:g} of 0", p[axis], kMostCoordinate));
  out_.vertices.push_back(p);
}

/// Returns whether all corners turn to one side, seen along the face's mean normal.
bool TriangleBuilder::is_convex(std::span<const std::uint64_t> corners) const {
  const std::size_t n = corners.size();
  const auto at = [&](std::size_t i) { return out_.vertices[corners[i % n]]; };
  glm::dvec3 normal{};
  for (std::size_t i = 1; i + 1 < n; ++i) normal += glm::cross(at(i) - at(0), at(i + 1) - at(0));
  const double rounding = 1e-12 * glm::dot(normal, normal);
  for (std::size_t i = 0; i < n; ++i)
    if (glm::dot(glm::cross(at(i + 1) - at(i), at(i + 2) - at(i + 1)), normal) < -rounding) return false;
  return true;
}

void TriangleBuilder::add_face(std::span<const std::uint64_t> corners, const MeshPlace& at) {
  if (corners.size() < 3) fail(at, "a face has fewer than three corners");
  for (const std::uint64_t corner : corners)
    if (corner >= vertices()) fail(at, fmt::format("a face refers to vertex {} of {} so far", corner + 1, vertices()));
  if (corners.size() > 3 && !is_convex(corners))
    fail(at, fmt::format("a face with {} corners is not convex; expected convex faces: divide it into triangles where "
                         "the file is made",
                         corners.size()));
  expect(out_.corners.size() / 3 + corners.size() - 2);
  const auto row = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
  for (std::size_t i = 1; i + 1 < corners.size(); ++i)
    out_.corners.insert(out_.corners.end(), {row(0), row(i), row(i + 1)});
}

Triangles TriangleBuilder::finish() {
  if (out_.corners.empty()) fail("has no triangles");
  return std::move(out_);
}

}  // namespace sf::world
