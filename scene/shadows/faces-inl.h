// Faces that may hide points from the light: their search along it, and the test of points.
// Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_SCENE_SHADOW_FACES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_SHADOW_FACES_INL_H
#undef SF_SCENE_SHADOW_FACES_INL_H
#else
#define SF_SCENE_SHADOW_FACES_INL_H
#endif

#include <cmath>
#include <glm/geometric.hpp>

#include "scene/shadows/points-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

constexpr std::uint32_t kAllDark = 0xFFFF;
constexpr float kLeastLightSine = 1e-5f;  // of faces that hide anything

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

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
