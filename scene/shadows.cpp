#include "scene/shadows.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

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
  std::uint32_t used = 0;  ///< bit mask
};

/// Box of points, with room for rounding.
struct PointBox {
  glm::vec3 middle, half;
};

struct ShadowCaster::Scratch {
  glm::vec3 light{};  ///< in the world
  float least = kLeastShadow;
  std::vector<ShadowMesh> meshes;
  std::vector<std::int32_t> stack;
  std::vector<ShadowFaces> faces;  ///< that may hide points of a group
};

}  // namespace sf::scene
#endif

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

using Shadows = ShadowCaster::Scratch;

constexpr std::uint32_t kGroup = 8;       // vectors
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

HWY_INLINE PointBox box_of(const LightPoints& points, std::uint32_t first, std::uint32_t end) {
  PointBox box;
  const float* const rows[3] = {points.x, points.y, points.z};
  for (int axis = 0; axis < 3; ++axis) {
    Floats low = load(rows[axis] + kWidth * first), high = low;
    for (std::uint32_t v = first + 1; v < end; ++v) {
      const Floats p = load(rows[axis] + kWidth * v);
      low = smaller(low, p), high = larger(high, p);
    }
    const float from = least(low), to = largest(high);
    box.middle[axis] = 0.5f * (from + to);
    box.half[axis] = 0.5f * (to - from) + 2e-6f * (std::abs(from) + std::abs(to));
  }
  return box;
}

/// Faces that may hide a point of a box, as a bit mask.
HWY_INLINE std::uint32_t hiding(const ShadowFaces& f, const PointBox& box) {
  const Vectors middle = all(box.middle), half = all(box.half);
  const auto most = [&](const Vectors& n, const Floats& offset) {
    return dot(n.x, n.y, n.z, middle.x, middle.y, middle.z) +
           dot(absolute(n.x), absolute(n.y), absolute(n.z), half.x, half.y, half.z) + offset;
  };
  const Floats zero = all(0.0f);
  Mask may = at_least(
      most({zero - load(f.normal[0]), zero - load(f.normal[1]), zero - load(f.normal[2])}, load(f.height)), zero);
  for (int k = 0; k < 4; ++k) may = both(may, at_least(most(load_rows(f.edge[k]), load(f.offset[k])), zero));
  return bits_of(may) & f.used;
}

/// Adds the faces of a leaf that may hide a point of the box.
HWY_INLINE void add_leaf(Shadows& s, const ShadowMesh& mesh, const TreeLeaf& leaf, const PointBox& box) {
  ShadowFaces& f = s.faces.emplace_back();
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
  }
  store(n.x, f.normal[0]), store(n.y, f.normal[1]), store(n.z, f.normal[2]);
  store(plain_dot(n, a[0]) - all(kRelative) * size, f.height);
  f.used = hiding(f, box);
  if (f.used == 0) s.faces.pop_back();
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
    PointBox own{glm::vec3(R_IW * (glm::dvec3(box.middle) - mesh.p) - tree.centre), {}};
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

void cast_points(Shadows& s, LightPoints& points, std::span<std::uint32_t> dark) {
  const std::uint32_t vectors = (points.count + kWidth - 1) / kWidth, last = points.count - 1;
  for (std::uint32_t i = points.count; i < vectors * kWidth; ++i)
    points.x[i] = points.x[last], points.y[i] = points.y[last], points.z[i] = points.z[last];
  for (std::uint32_t first = 0; first < vectors; first += kGroup) {
    const std::uint32_t end = std::min(vectors, first + kGroup);
    list_faces(s, box_of(points, first, end));
    for (std::uint32_t v = first; v < end; ++v) {
      dark[v] = 0;
      if (s.faces.empty()) continue;
      const PointBox box = box_of(points, v, v + 1);
      const std::uint32_t at = kWidth * v;
      const Vectors p{load(points.x + at), load(points.y + at), load(points.z + at)};
      const Floats room = all(s.least) + all(kRelative) * sum_of_sizes(p);
      for (const ShadowFaces& faces : s.faces) {
        for (std::uint32_t rest = hiding(faces, box); rest != 0 && dark[v] != 0xFFFF; rest &= rest - 1)
          dark[v] |= hidden_by(faces, static_cast<std::uint32_t>(__builtin_ctz(rest)), p, room);
        if (dark[v] == 0xFFFF) break;
      }
    }
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

void ShadowCaster::begin(glm::dvec3 p_W, glm::dvec3 to_light, std::span<const Instance> instances, float least) {
  Scratch& s = *scratch_;
  s.least = least;
  s.light = glm::vec3(to_light);
  s.meshes.clear();
  for (const Instance& instance : instances) {
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
