// Sixteen faces as seen from the sensor: edges and inverse ranges as linear functions of the direction, with error
// bounds (rasterizer.h). Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_SCENE_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_LEAF_INL_H
#undef SF_SCENE_LEAF_INL_H
#else
#define SF_SCENE_LEAF_INL_H
#endif

#include "scene/rasterizer/aim-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

constexpr float kRounding = 1.0f / (1 << 24);
constexpr float kUnbounded = 1e30f;

/// Faces of a leaf that are not hidden behind their own body, one bit each.
struct LeafFaces {
  std::uint32_t open = 0;     ///< seen at an angle
  std::uint32_t edge_on = 0;  ///< may be anywhere
};

/// Returns the faces that are certainly back faces of closed bodies, seen from outside. @param p [m] the sensor
/// relative to the leaf's centre  @param h [m] as in view_leaf  @param reach [m] distance of the leaf's farthest point
HWY_INLINE std::uint32_t hidden_faces(const TreeLeaf& leaf, const float (&p)[3], const Floats& h, float reach) {
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) inside = inside && leaf.body[axis] <= p[axis] && p[axis] <= leaf.body[axis + 3];
  if (leaf.outward == 0 || inside) return 0;
  const Floats sure = all(25.0f * kRounding * reach);
  return (bits_of(greater(h, sure)) & leaf.outward) | (bits_of(greater(all(0.0f) - sure, h)) & leaf.outward >> kWidth);
}

HWY_INLINE LeafFaces view_leaf(Scratch& s, const TreeLeaf& leaf, const SceneMesh& mesh) {
  LeafView& view = s.leaf;
  view.face = leaf.face;
  const glm::dvec3 p = mesh.X_FS.p - glm::dvec3{leaf.centre[0], leaf.centre[1], leaf.centre[2]};
  const float reach = (static_cast<float>(glm::length(p)) + leaf.radius) * 1.00001f;
  const float p32[3] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  const Floats px = all(p32[0]), py = all(p32[1]), pz = all(p32[2]);
  Floats x[4], y[4], z[4];
  for (int k = 0; k < 4; ++k) x[k] = load(leaf.corner[k][0]) - px;
  for (int k = 0; k < 4; ++k) y[k] = load(leaf.corner[k][1]) - py;
  for (int k = 0; k < 4; ++k) z[k] = load(leaf.corner[k][2]) - pz;
  const Floats nx = load(leaf.normal[0]), ny = load(leaf.normal[1]), nz = load(leaf.normal[2]);
  const Floats h = dot(nx, ny, nz, x[0], y[0], z[0]);
  const std::uint32_t used = ((1u << leaf.count) - 1) & ~hidden_faces(leaf, p32, h, reach);
  if (used == 0) return {};
  Floats square = all(0.0f);
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    const auto along = [&](int axis) { return load(leaf.corner[next][axis]) - load(leaf.corner[k][axis]); };
    const Floats ex = along(0), ey = along(1), ez = along(2);
    const Floats a = turned(mulsub(y[k], ez, z[k] * ey), h), b = turned(mulsub(z[k], ex, x[k] * ez), h),
                 c = turned(mulsub(x[k], ey, y[k] * ex), h);
    store(a, view.edge[3 * k]), store(b, view.edge[3 * k + 1]), store(c, view.edge[3 * k + 2]);
    square = larger(square, dot(a, b, c, a, b, c));
  }
  store(muladd(all(kRounding * reach), load(leaf.extent), root(square) * all(14.001f * kRounding)), view.edge_error);
  const Floats inverse = all(1.0f) / h, size = absolute(inverse);
  const Floats relative = all(6.0f * kRounding * reach) * size;
  const Mask open = greater(all(0.25f), relative);
  store(select_or_zero(open, nx * inverse), view.inverse[0]);
  store(select_or_zero(open, ny * inverse), view.inverse[1]);
  store(select_or_zero(open, nz * inverse), view.inverse[2]);
  store(select(open, size * all(17.0f * kRounding), all(kUnbounded)), view.slack);
  const Floats part = select_or_zero(open, relative * all(1.4f));
  store(all(1.0f) + part, view.above), store(all(1.0f) - part, view.below);
  const std::uint32_t opened = bits_of(open) & used;
  return {opened, used & ~opened};
}

/// Rotates the view of a leaf into the sensor's frame. Beams in that frame have the same bounds of errors.
HWY_INLINE void turn_to_sensor(LeafView& view, const SceneMesh& mesh) {
  const Rotation R(glm::transpose(mesh.X_FS.R));
  const auto turn = [&](float(*v)[kWidth]) {
    const Floats x = load(v[0]), y = load(v[1]), z = load(v[2]);
    for (int k = 0; k < 3; ++k) store(R.row(k, x, y, z), v[k]);
  };
  for (int k = 0; k < 12; k += 3) turn(view.edge + k);
  turn(view.inverse);
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
