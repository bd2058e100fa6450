#include "scene/shadows.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <span>

#include "scene/shadows/scratch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_SSSE3 | HWY_AVX3_DL)
#define HWY_TARGET_INCLUDE "scene/shadows.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h: the code that is compiled per instruction set.
#include "scene/shadows/faces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

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
