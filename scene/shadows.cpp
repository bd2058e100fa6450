#include "scene/shadows.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "scene/field_shadow.h"

#undef HWY_TARGET_INCLUDE
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "scene/shadows.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h: the code that is compiled per instruction set.
#include "scene/rasterizer/vectors-inl.h"

#ifndef SF_SCENE_SHADOWS_ONCE
#define SF_SCENE_SHADOWS_ONCE
namespace sf::scene {

/// A mesh of the scene.
struct ShadowMesh {
  const SurfaceTree* tree = nullptr;
  bool turned = false;
  glm::dmat3 R_WI{1.0};
  glm::dvec3 p{};       ///< [m] its frame's origin, from the sensor in the world's axes
  glm::dvec3 centre{};  ///< [m] its middle, in the same way
  glm::vec3 light{};    ///< direction in its frame, no coordinate is 0
};

/// Up to sixteen faces: p is behind face i if edge_k . p + offset_k >= 0 for all k and height - normal . p > 0.
struct ShadowFaces {
  alignas(64) float edge[4][3][kWidth], offset[4][kWidth], normal[3][kWidth], height[kWidth];
  alignas(64) float across[4][2][kWidth];  ///< the edges along Scratch::across, which with the light span the world
  std::uint32_t used = 0;                  ///< bit mask
};

/// Box of points, with room for rounding.
struct PointBox {
  glm::vec3 middle, half;
  glm::vec2 across_middle, across_half;  ///< along Scratch::across
};

struct ShadowCaster::Scratch {
  glm::vec3 light{};      ///< in the world
  glm::vec3 across[2]{};  ///< unit vectors across the light, at right angles
  float least = kLeastShadow;
  std::vector<ShadowMesh> meshes;
  std::vector<std::int32_t> stack;
  std::vector<ShadowFaces> faces;  ///< that may hide points of a group
  ShadowFaces last;                ///< that hid points, in a ring
  std::uint32_t hid = 0;           ///< how many did
  FieldShadow field;
};

}  // namespace sf::scene
#endif

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

using Shadows = ShadowCaster::Scratch;

constexpr std::uint32_t kGroup = 8;  // vectors
constexpr std::uint32_t kAllDark = 0xFFFF;
constexpr float kApart = 1.2f;            // ratio of squared distances
constexpr float kRelative = 4e-7f;        // of coordinates
constexpr float kLeastLightSine = 1e-5f;  // of faces that hide anything

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

/// Faces that may hide a point of a box, as a bit mask.
HWY_INLINE std::uint32_t hiding(const Shadows& s, const ShadowFaces& f, const PointBox& box) {
  const Vectors n = load_rows(f.normal), middle = all(box.middle), half = all(box.half);
  Mask may = greater(load(f.height) - dot(n.x, n.y, n.z, middle.x, middle.y, middle.z) +
                         dot(absolute(n.x), absolute(n.y), absolute(n.z), half.x, half.y, half.z),
                     all(s.least));
  const Floats u = all(box.across_middle.x), v = all(box.across_middle.y);
  const Floats half_u = all(box.across_half.x), half_v = all(box.across_half.y);
  for (int k = 0; k < 4; ++k) {
    const Floats x = load(f.across[k][0]), y = load(f.across[k][1]);
    const Floats most =
        muladd(x, u, muladd(y, v, load(f.offset[k]))) + muladd(absolute(x), half_u, absolute(y) * half_v);
    may = both(may, at_least(most, all(0.0f)));
  }
  return bits_of(may) & f.used;
}

/// Copies face `i` of some to place `k` of others.
HWY_INLINE void copy_face(const ShadowFaces& from, std::uint32_t i, ShadowFaces& to, std::uint32_t k) {
  for (int e = 0; e < 4; ++e) {
    for (int axis = 0; axis < 3; ++axis) to.edge[e][axis][k] = from.edge[e][axis][i];
    for (int axis = 0; axis < 2; ++axis) to.across[e][axis][k] = from.across[e][axis][i];
    to.offset[e][k] = from.offset[e][i];
  }
  for (int axis = 0; axis < 3; ++axis) to.normal[axis][k] = from.normal[axis][i];
  to.height[k] = from.height[i];
  to.used |= 1u << k;
}

/// Adds the faces of a leaf that may hide a point of the box.
HWY_INLINE void add_leaf(Shadows& s, const ShadowMesh& mesh, const TreeLeaf& leaf, const PointBox& box) {
  ShadowFaces f;
  const glm::mat3 R(mesh.R_WI);
  const glm::dvec3 centre{leaf.centre[0], leaf.centre[1], leaf.centre[2]};
  const Vectors from = all(glm::vec3(mesh.p + mesh.R_WI * centre)), light = all(s.light);
  Vectors n = load_rows(leaf.normal), corner[4];
  for (int k = 0; k < 4; ++k) corner[k] = load_rows(leaf.corner[k]);
  if (mesh.turned) {
    n = rotated(R, n);
    for (Vectors& c : corner) c = rotated(R, c);
  }
  const Floats sine = plain_dot(n, light);
  f.used = bits_of(greater(absolute(sine), all(kLeastLightSine))) & ((1u << leaf.count) - 1);
  // Light that meets a closed body leaves it on the side of the light: its other faces need not be tested.
  const std::uint32_t lit = bits_of(greater(sine, all(0.0f)));
  f.used &= ~((~lit & leaf.outward) | (lit & leaf.outward >> kWidth));
  n = {turned(n.x, sine), turned(n.y, sine), turned(n.z, sine)};
  Floats size = all(0.0f);
  Vectors a[4];
  for (int k = 0; k < 4; ++k) {
    a[k] = {corner[k].x + from.x, corner[k].y + from.y, corner[k].z + from.z};
    size = larger(size, sum_of_sizes(a[k]));
  }
  for (int k = 0; k < 4; ++k) {
    const Vectors &p = corner[k], &q = corner[(k + 1) % 4];
    const Vectors e{q.x - p.x, q.y - p.y, q.z - p.z};
    const Vectors m{turned(light.y * e.z - light.z * e.y, sine), turned(light.z * e.x - light.x * e.z, sine),
                    turned(light.x * e.y - light.y * e.x, sine)};
    // Faces grow by this much, so that no light passes between two that share an edge.
    const Floats grown = all(4.0f * kRelative) * (sum_of_sizes(m) * size);
    store(m.x, f.edge[k][0]), store(m.y, f.edge[k][1]), store(m.z, f.edge[k][2]);
    store(grown - plain_dot(m, a[k]), f.offset[k]);
    for (int axis = 0; axis < 2; ++axis) store(plain_dot(m, all(s.across[axis])), f.across[k][axis]);
  }
  store(n.x, f.normal[0]), store(n.y, f.normal[1]), store(n.z, f.normal[2]);
  store(plain_dot(n, a[0]) - all(kRelative) * size, f.height);
  for (std::uint32_t rest = hiding(s, f, box); rest != 0; rest &= rest - 1) {
    if (s.faces.empty() || s.faces.back().used == 0xFFFF) s.faces.emplace_back();
    ShadowFaces& to = s.faces.back();
    copy_face(f, static_cast<std::uint32_t>(__builtin_ctz(rest)), to,
              static_cast<std::uint32_t>(__builtin_popcount(to.used)));
  }
}

/// Children of a node that the box meets on its way to the light. @param box in the mesh's frame, from the tree's
/// middle
HWY_INLINE std::uint32_t children_on_way(const TreeNode& node, const PointBox& box, glm::vec3 light) {
  Floats enter = all(0.0f), leave = all(1e30f);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats inverse = all(1.0f / light[axis]);
    const int low = light[axis] > 0.0f ? axis : axis + 3, high = light[axis] > 0.0f ? axis + 3 : axis;
    const float room = light[axis] > 0.0f ? box.half[axis] : -box.half[axis];
    enter = larger(enter, (load(node.bound[low]) - all(box.middle[axis] + room)) * inverse);
    leave = smaller(leave, (load(node.bound[high]) - all(box.middle[axis] - room)) * inverse);
  }
  return bits_of(at_least(leave, enter));
}

HWY_INLINE bool may_meet(const ShadowMesh& mesh, const PointBox& box, glm::dvec3 light) {
  const glm::dvec3 d = mesh.centre - glm::dvec3(box.middle);
  const double reach = (mesh.tree->radius + glm::length(glm::dvec3(box.half))) * 1.00001, along = glm::dot(d, light);
  return along > -reach && glm::dot(d, d) - along * along < reach * reach * 1.00001;
}

/// Lists the faces that may hide points of the box.
void list_faces(Shadows& s, const PointBox& box) {
  s.faces.clear();
  for (const ShadowMesh& mesh : s.meshes) {
    if (!may_meet(mesh, box, s.light)) continue;
    const SurfaceTree& tree = *mesh.tree;
    const glm::dmat3 R_IW = glm::transpose(mesh.R_WI);
    PointBox own{glm::vec3(R_IW * (glm::dvec3(box.middle) - mesh.p) - tree.centre), {}, {}, {}};
    for (int axis = 0; axis < 3; ++axis) {
      const glm::dvec3 row = mesh.R_WI[axis];
      own.half[axis] =
          static_cast<float>(std::abs(row.x) * box.half.x + std::abs(row.y) * box.half.y +
                             std::abs(row.z) * box.half.z + 2e-6 * (tree.radius + std::abs(own.middle[axis])));
    }
    s.stack.assign(1, tree.root);
    while (!s.stack.empty()) {
      const std::int32_t row = s.stack.back();
      s.stack.pop_back();
      if (row < 0) {
        add_leaf(s, mesh, tree.leaves[~row], box);
        continue;
      }
      const TreeNode& node = tree.nodes[row];
      for (std::uint32_t rest = children_on_way(node, own, mesh.light); rest != 0; rest &= rest - 1)
        s.stack.push_back(node.child[__builtin_ctz(rest)]);
    }
  }
}

HWY_INLINE std::uint32_t hidden_by(const ShadowFaces& f, std::uint32_t i, const Vectors& p, const Floats& room) {
  const auto along = [&](const float(*n)[kWidth]) { return plain_dot(p, all(glm::vec3(n[0][i], n[1][i], n[2][i]))); };
  Mask hidden = greater(all(f.height[i]) - along(f.normal), room);
  for (int k = 0; k < 4; ++k) hidden = both(hidden, at_least(along(f.edge[k]) + all(f.offset[k][i]), all(0.0f)));
  return bits_of(hidden);
}

/// Adds the points of a vector that some faces hide to `dark`, a bit mask.
HWY_INLINE void hide(Shadows& s, const ShadowFaces& faces, const PointBox& box, const Vectors& p, const Floats& room,
                     std::uint32_t& dark) {
  for (std::uint32_t rest = hiding(s, faces, box); rest != 0 && dark != kAllDark; rest &= rest - 1) {
    const auto i = static_cast<std::uint32_t>(__builtin_ctz(rest));
    const std::uint32_t more = hidden_by(faces, i, p, room) & ~dark;
    dark |= more;
    if (more != 0 && &faces != &s.last) copy_face(faces, i, s.last, s.hid++ % kWidth);
  }
}

/// Hides points of a group of vectors by the terrain.
void cast_field(const Shadows& s, const LightPoints& points, std::uint32_t first, std::uint32_t end,
                std::span<std::uint32_t> dark) {
  for (std::uint32_t i = kWidth * first; i < kWidth * end; ++i) {
    const glm::vec3 p{points.x[i], points.y[i], points.z[i]};
    const float room = s.least + kRelative * (std::abs(p.x) + std::abs(p.y) + std::abs(p.z));
    std::uint32_t& mask = dark[i / kWidth];
    if ((mask >> i % kWidth & 1) == 0 && s.field.hides(p, room)) mask |= 1u << i % kWidth;
  }
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

/// Hides points of some clusters by meshes. @param dark per vector of the group
void cast_clusters(Shadows& s, const PointGroup& group, std::span<const PointCluster> clusters, std::uint32_t* dark) {
  if (clusters.empty()) return;
  list_faces(s, box_around(clusters));
  for (const PointCluster& cluster : clusters)
    for (const ShadowFaces& faces : s.faces)
      hide(s, faces, cluster.box, group.p[cluster.vector], group.room[cluster.vector], dark[cluster.vector]);
}

/// Hides points of a group of vectors by meshes.
void cast_group(Shadows& s, const LightPoints& points, std::uint32_t first, std::uint32_t end,
                std::span<std::uint32_t> dark) {
  PointGroup group;
  for (std::uint32_t v = first; v < end; ++v) {
    const std::uint32_t at = kWidth * v, i = v - first, before = group.size;
    group.p[i] = {load(points.x + at), load(points.y + at), load(points.z + at)};
    group.room[i] = all(s.least) + all(kRelative) * sum_of_sizes(group.p[i]);
    dark[v] = 0;
    add_clusters(s, group.p[i], i, group);
    for (std::uint32_t c = before; c < group.size; ++c)
      hide(s, s.last, group.clusters[c].box, group.p[i], group.room[i], dark[v]);
    if (dark[v] == kAllDark) group.size = before;
  }
  const std::span clusters = std::span(group.clusters).first(group.size);
  const auto [near, far] = std::ranges::minmax_element(clusters, {}, &PointCluster::far);
  const float middle =
      clusters.empty() ? 0.0f : std::sqrt(near->far * far->far) * (far->far > 2.0f * near->far ? 1.0f : 0.0f);
  const auto others = std::ranges::partition(clusters, [&](const PointCluster& c) { return c.far < middle; });
  cast_clusters(s, group, clusters.first(clusters.size() - others.size()), &dark[first]);
  cast_clusters(s, group, others, &dark[first]);
}

void cast_points(Shadows& s, LightPoints& points, std::span<std::uint32_t> dark) {
  const std::uint32_t vectors = (points.count + kWidth - 1) / kWidth, last = points.count - 1;
  for (std::uint32_t i = points.count; i < vectors * kWidth; ++i)
    points.x[i] = points.x[last], points.y[i] = points.y[last], points.z[i] = points.z[last];
  for (std::uint32_t first = 0; first < vectors; first += kGroup) {
    const std::uint32_t end = std::min(vectors, first + kGroup);
    cast_group(s, points, first, end, dark);
    if (!s.field.empty()) cast_field(s, points, first, end, dark);
  }
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sf::scene {

HWY_EXPORT(cast_points);

ShadowCaster::ShadowCaster() : scratch_(std::make_unique<Scratch>()) {}
ShadowCaster::~ShadowCaster() = default;
ShadowCaster::ShadowCaster(ShadowCaster&&) noexcept = default;

void ShadowCaster::begin(glm::dvec3 p_W, glm::dvec3 to_light, const SceneView& scene, float least) {
  Scratch& s = *scratch_;
  s.least = least;
  s.light = glm::vec3(to_light);
  const glm::dvec3 other = std::abs(to_light.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(to_light, other));
  s.across[0] = glm::vec3(across), s.across[1] = glm::vec3(glm::cross(to_light, across));
  s.last.used = s.hid = 0;
  s.field = scene.terrain.field != nullptr ? FieldShadow(scene.terrain, p_W, to_light) : FieldShadow();
  s.meshes.clear();
  for (const Instance& instance : scene.instances) {
    if (instance.tree->empty()) continue;
    ShadowMesh mesh{instance.tree, !instance.at_origin};
    if (mesh.turned) mesh.R_WI = instance.X_WI.R;
    mesh.p = (mesh.turned ? instance.X_WI.p : glm::dvec3{}) - p_W;
    mesh.centre = mesh.p + mesh.R_WI * instance.tree->centre;
    mesh.light = glm::vec3(glm::transpose(mesh.R_WI) * to_light);
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(mesh.light[axis]) < 1e-7f) mesh.light[axis] = 1e-7f;
    s.meshes.push_back(mesh);
  }
}

void ShadowCaster::cast(LightPoints& points, std::span<std::uint32_t> dark) {
  if (points.count > 0) HWY_DYNAMIC_DISPATCH(cast_points)(*scratch_, points, dark);
}

}  // namespace sf::scene
#endif
