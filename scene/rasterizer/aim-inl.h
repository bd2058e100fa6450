// Rotates a tile's beams and boxes into the frame of a mesh. Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_SCENE_AIM_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_AIM_INL_H
#undef SF_SCENE_AIM_INL_H
#else
#define SF_SCENE_AIM_INL_H
#endif

#include "scene/rasterizer/vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

struct Rotation {
  float r[3][3];  ///< rows

  explicit Rotation(const glm::dmat3& R) {
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) r[row][column] = static_cast<float>(R[column][row]);
  }
  HWY_INLINE Floats row(int k, const Floats& x, const Floats& y, const Floats& z) const {
    return dot(all(r[k][0]), all(r[k][1]), all(r[k][2]), x, y, z);
  }
  HWY_INLINE float row(int k, const float (&v)[3]) const { return r[k][0] * v[0] + r[k][1] * v[1] + r[k][2] * v[2]; }
};

/// Rotates `vectors` triples of coordinates, each an array of 32.
HWY_INLINE void rotate_boxes(const Rotation& R, const float (*from)[kTileVectors], float (*to)[kTileVectors],
                             int vectors) {
  for (int i = 0; i < 3 * vectors; i += 3)
    for (std::uint32_t g = 0; g < kTileVectors; g += kWidth) {
      const Floats x = load(from[i] + g), y = load(from[i + 1] + g), z = load(from[i + 2] + g);
      for (int k = 0; k < 3; ++k) store(R.row(k, x, y, z), to[i + k] + g);
    }
}

HWY_INLINE void rotate_box(const Rotation& R, const float (*from)[1], float (*to)[1], int vectors) {
  for (int i = 0; i < 3 * vectors; i += 3) {
    const float v[3] = {from[i][0], from[i + 1][0], from[i + 2][0]};
    for (int k = 0; k < 3; ++k) to[i + k][0] = R.row(k, v);
  }
}

/// The sensor relative to a mesh's centre, in 32 bits. Offsets have room for the rounding of boxes, normals and
/// products.
struct Eye {
  float v[3];
  float room;
  explicit Eye(const SceneMesh& mesh) {
    const glm::dvec3 p = mesh.X_FS.p - mesh.tree->centre;
    room = static_cast<float>(1e-6 * (mesh.tree->radius + glm::length(p)));
    for (int axis = 0; axis < 3; ++axis) v[axis] = static_cast<float>(p[axis]);
  }
};

/// Fills in the tile's box and its offsets in the mesh's frame.
HWY_INLINE void aim_tile(Scratch& s, const BeamTile& tile, const SceneMesh& mesh) {
  const Rotation R(mesh.X_FS.R);
  rotate_box(R, tile.tile.box, s.tile.box, 3);
  rotate_box(R, tile.tile.plane, s.tile.plane, 4);
  rotate_box(R, tile.tile.axis, s.tile.axis, 1);
  const Eye eye(mesh);
  const auto offset = [&](const float(*n)[1]) { return n[0][0] * eye.v[0] + n[1][0] * eye.v[1] + n[2][0] * eye.v[2]; };
  for (int k = 0; k < 4; ++k) s.tile_side_offset[k] = offset(s.tile.plane + 3 * k) - eye.room;
  s.tile_axis_offset = offset(s.tile.axis) + eye.room;
}

/// Fills in the beams, and the boxes and offsets of the vectors, in the mesh's frame.
HWY_INLINE void aim_beams(Scratch& s, const BeamTile& tile, const SceneMesh& mesh) {
  const Rotation R(mesh.X_FS.R);
  for (std::uint32_t i = 0; i < kWidth * tile.used; i += kWidth) {
    const Floats x = load(tile.x + i), y = load(tile.y + i), z = load(tile.z + i);
    store(R.row(0, x, y, z), s.x + i), store(R.row(1, x, y, z), s.y + i), store(R.row(2, x, y, z), s.z + i);
  }
  rotate_boxes(R, tile.vectors.box, s.vectors.box, 3);
  rotate_boxes(R, tile.vectors.plane, s.vectors.plane, 4);
  rotate_boxes(R, tile.vectors.axis, s.vectors.axis, 1);
  const Eye eye(mesh);
  const Floats x = all(eye.v[0]), y = all(eye.v[1]), z = all(eye.v[2]);
  for (std::uint32_t g = 0; g < kTileVectors; g += kWidth) {
    const auto offset = [&](const float(*n)[kTileVectors]) {
      return dot(load(n[0] + g), load(n[1] + g), load(n[2] + g), x, y, z);
    };
    for (int k = 0; k < 12; ++k) store(absolute(load(s.vectors.plane[k] + g)), s.side_size[k] + g);
    for (int k = 0; k < 3; ++k) store(absolute(load(s.vectors.axis[k] + g)), s.axis_size[k] + g);
    for (int k = 0; k < 4; ++k) store(offset(s.vectors.plane + 3 * k) - all(eye.room), s.side_offset[k] + g);
    store(offset(s.vectors.axis) + all(eye.room), s.axis_offset + g);
  }
}

/// Largest and smallest n . d over boxes of directions.
struct Extent {
  Floats low, high;
};
HWY_INLINE Extent extent(const Floats& x, const Floats& y, const Floats& z, const Floats (&box)[9]) {
  const Floats middle = dot(x, y, z, box[0], box[1], box[2]);
  const Floats half = absolute(dot(x, y, z, box[3], box[4], box[5])) + absolute(dot(x, y, z, box[6], box[7], box[8]));
  return {middle - half, middle + half};
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
