// Points that may be in a shadow, grouped for the search for faces that hide them from the light.
// Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_SCENE_SHADOW_POINTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_SHADOW_POINTS_INL_H
#undef SF_SCENE_SHADOW_POINTS_INL_H
#else
#define SF_SCENE_SHADOW_POINTS_INL_H
#endif

#include <cmath>
#include <glm/common.hpp>
#include <span>
#include <utility>

#include "scene/rasterizer/vectors-inl.h"
#include "scene/shadows/scratch.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

using Shadows = ShadowCaster::Scratch;

constexpr std::uint32_t kGroup = 8;  // vectors
constexpr float kApart = 1.2f;       // ratio of squared distances
constexpr float kRelative = 4e-7f;   // of coordinates

struct Vectors {
  Floats x, y, z;
};

/// a . b without fused operations.
HWY_INLINE Floats plain_dot(const Vectors& a, const Vectors& b) { return (a.x * b.x + a.y * b.y) + a.z * b.z; }
HWY_INLINE Floats sum_of_sizes(const Vectors& a) { return (absolute(a.x) + absolute(a.y)) + absolute(a.z); }
HWY_INLINE Vectors all(glm::vec3 v) { return {all(v.x), all(v.y), all(v.z)}; }
HWY_INLINE Vectors load_rows(const float (*rows)[kWidth]) { return {load(rows[0]), load(rows[1]), load(rows[2])}; }

HWY_INLINE Vectors rotated(const glm::mat3& R, const Vectors& v) {
  return {(all(R[0].x) * v.x + all(R[1].x) * v.y) + all(R[2].x) * v.z,
          (all(R[0].y) * v.x + all(R[1].y) * v.y) + all(R[2].y) * v.z,
          (all(R[0].z) * v.x + all(R[1].z) * v.y) + all(R[2].z) * v.z};
}

HWY_INLINE float largest(const Floats& a) {
  auto v = a.part[0];
  for (std::size_t p = 1; p < kParts; ++p) v = hn::Max(v, a.part[p]);
  return hn::GetLane(hn::MaxOfLanes(kF, v));
}

/// Points of a vector that are about as far from the sensor.
struct PointCluster {
  std::uint32_t vector = 0;  ///< in the group
  float far = 0.0f;          ///< [m^2] distance of one, squared
  PointBox box;
};

/// Points of a group.
struct PointGroup {
  Vectors p[kGroup];
  Floats room[kGroup];
  PointCluster clusters[2 * kGroup];
  std::uint32_t size = 0;  ///< clusters that are not dark
};

HWY_INLINE PointBox box_of(const Shadows& s, const Vectors& p) {
  PointBox box;
  const Floats* const rows[3] = {&p.x, &p.y, &p.z};
  for (int axis = 0; axis < 3; ++axis) {
    const float from = least(*rows[axis]), to = largest(*rows[axis]);
    box.middle[axis] = 0.5f * (from + to);
    box.half[axis] = 0.5f * (to - from) + 2e-6f * (std::abs(from) + std::abs(to));
  }
  const float room = 4e-6f * largest(sum_of_sizes(p));
  for (int axis = 0; axis < 2; ++axis) {
    const Floats along = plain_dot(p, all(s.across[axis]));
    const float from = least(along), to = largest(along);
    box.across_middle[axis] = 0.5f * (from + to), box.across_half[axis] = 0.5f * (to - from) + room;
  }
  return box;
}

/// Sets the box around two, with room for rounding.
template <class Vector>
HWY_INLINE void enclose(const Vector& low, const Vector& high, Vector& middle, Vector& half) {
  middle = 0.5f * (low + high), half = (0.5f + 1e-6f) * (high - low) + 1e-6f * (glm::abs(low) + glm::abs(high));
}

/// The box around those of some clusters.
HWY_INLINE PointBox box_around(std::span<const PointCluster> clusters) {
  glm::vec3 low(HUGE_VALF), high(-HUGE_VALF);
  glm::vec2 left(HUGE_VALF), right(-HUGE_VALF);
  for (const PointCluster& c : clusters) {
    low = glm::min(low, c.box.middle - c.box.half), high = glm::max(high, c.box.middle + c.box.half);
    left = glm::min(left, c.box.across_middle - c.box.across_half);
    right = glm::max(right, c.box.across_middle + c.box.across_half);
  }
  PointBox box;
  enclose(low, high, box.middle, box.half), enclose(left, right, box.across_middle, box.across_half);
  return box;
}

/// Adds a vector's points. Those on both sides of a border between surfaces get boxes of their own.
HWY_INLINE void add_clusters(const Shadows& s, const Vectors& p, std::uint32_t vector, PointGroup& group) {
  const Floats far = plain_dot(p, p);
  const float from = least(far), to = largest(far), middle = std::sqrt(from * to);
  if (!(from > 1e-20f && to > kApart * from)) return void(group.clusters[group.size++] = {vector, to, box_of(s, p)});
  const Mask is_near = greater(all(middle), far), is_far = at_least(far, all(middle));
  for (const auto& [mask, of] : {std::pair{&is_near, from}, {&is_far, to}}) {
    const auto i = static_cast<std::size_t>(__builtin_ctz(bits_of(*mask)));
    const auto only = [&](const Floats& row) {
      alignas(64) float lanes[kWidth];
      store(row, lanes);
      return select(*mask, row, all(lanes[i]));
    };
    group.clusters[group.size++] = {vector, of, box_of(s, {only(p.x), only(p.y), only(p.z)})};
  }
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
