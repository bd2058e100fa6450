#include "scene/faces_apart.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace sf::scene {

namespace {

constexpr double kSeparation = 1e-11;   // of the faces' size
constexpr std::uint32_t kNoCorner = 4;  // no corner

glm::dvec3 normal_of(const SweptFace& f) { return glm::cross(f.at[1] - f.at[0], f.at[2] - f.at[0]); }

glm::dvec3 edge(const SweptFace& f, std::uint32_t k) { return f.at[(k + 1) % f.corners] - f.at[k]; }

/// Calls `test` with axes of separation until it returns true.
template <class Test>
bool any_axis(const SweptFace& a, const SweptFace& b, const Test& test) {
  const glm::dvec3 na = normal_of(a), nb = normal_of(b);
  if (test(na) || test(nb)) return true;
  for (std::uint32_t i = 0; i < a.corners; ++i) {
    if (test(glm::cross(na, edge(a, i)))) return true;
    for (std::uint32_t k = 0; k < b.corners; ++k)
      if (test(glm::cross(edge(a, i), edge(b, k)))) return true;
  }
  for (std::uint32_t k = 0; k < b.corners; ++k)
    if (test(glm::cross(nb, edge(b, k)))) return true;
  return false;
}

/// Corners of a face along an axis, relative to a point.
struct Heights {
  double low = HUGE_VAL, high = -HUGE_VAL;
  std::uint32_t level = 0;  ///< corners at the height of the point
  glm::dvec3 beside{};      ///< one of them

  /// @param skipped corner that does not count; kNoCorner: all do
  Heights(const SweptFace& f, glm::dvec3 from, std::uint32_t skipped, glm::dvec3 axis, double room) {
    for (std::uint32_t k = 0; k < f.corners; ++k) {
      if (k == skipped) continue;
      const glm::dvec3 p = f.at[k] - from;
      const double height = glm::dot(axis, p);
      low = std::min(low, height), high = std::max(high, height);
      if (std::abs(height) <= room) ++level, beside = p;
    }
  }
};

bool same_direction(glm::dvec3 p, glm::dvec3 q) {
  return glm::dot(p, q) >= (1.0 - 1e-9) * glm::length(p) * glm::length(q);
}

/// Faces that share corner i of one and k of the other: a plane through it has one of them on each side, and they do
/// not meet in the plane.
bool are_apart_at(const SweptFace& a, std::uint32_t i, const SweptFace& b, std::uint32_t k, double size) {
  return any_axis(a, b, [&](glm::dvec3 axis) {
    const double room = kSeparation * size * glm::length(axis);
    if (!(room > 0.0)) return false;
    for (const double sign : {1.0, -1.0}) {
      const Heights below(a, a.at[i], i, sign * axis, room), above(b, b.at[k], k, sign * axis, room);
      if (below.high > room || above.low < -room) continue;
      if (below.level == 0 || above.level == 0) return true;
      if (below.level == 1 && above.level == 1 && !same_direction(below.beside, above.beside)) return true;
    }
    return false;
  });
}

/// Neighbours: they meet only in their edge unless one is folded onto the other.
bool are_apart_along(const SweptFace& a, const SweptFace& b, std::pair<std::uint32_t, std::uint32_t> i,
                     std::pair<std::uint32_t, std::uint32_t> k) {
  const auto inward = [](const SweptFace& f, std::pair<std::uint32_t, std::uint32_t> shared) {
    const glm::dvec3 along = glm::normalize(f.at[shared.second] - f.at[shared.first]);
    glm::dvec3 middle{};
    for (std::uint32_t c = 0; c < f.corners; ++c) middle += f.at[c] - f.at[shared.first];
    return glm::normalize(middle - along * glm::dot(along, middle));
  };
  const auto is_edge = [](const SweptFace& f, std::pair<std::uint32_t, std::uint32_t> shared) {
    const std::uint32_t apart = shared.second - shared.first;
    return apart == 1 || apart == f.corners - 1;
  };
  return is_edge(a, i) && is_edge(b, k) && glm::dot(inward(a, i), inward(b, k)) < 1.0 - 1e-9;
}

}  // namespace

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.high[axis] < b.low[axis] || b.high[axis] < a.low[axis]) return false;
  return true;
}

bool are_apart(const SweptFace& a, const SweptFace& b) {
  std::array<std::pair<std::uint32_t, std::uint32_t>, 4> shared;  // corners of a and b
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < a.corners; ++i)
    for (std::uint32_t k = 0; k < b.corners; ++k)
      if (a.vertex[i] == b.vertex[k]) {
        if (count == 2) return false;
        shared[count++] = {i, k};
      }
  Bounds both = a.box;
  both.add(b.box);
  const double size = glm::length(both.high - both.low);
  if (count == 1) return are_apart_at(a, shared[0].first, b, shared[0].second, size);
  if (count == 2)
    return are_apart_along(
        a, b, {shared[0].first, shared[1].first},
        {std::min(shared[0].second, shared[1].second), std::max(shared[0].second, shared[1].second)});
  return any_axis(a, b, [&](glm::dvec3 axis) {
    const double room = kSeparation * size * glm::length(axis);
    if (!(room > 0.0)) return false;
    const Heights of_a(a, a.at[0], kNoCorner, axis, room), of_b(b, a.at[0], kNoCorner, axis, room);
    return of_a.high + room < of_b.low || of_b.high + room < of_a.low;
  });
}

}  // namespace sf::scene
