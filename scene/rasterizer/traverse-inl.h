// Walks a mesh's tree from near to far and draws the leaves that the tile may see. Compiled once per instruction set
// (hwy/foreach_target.h).

#if defined(SF_SCENE_TRAVERSE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_TRAVERSE_INL_H
#undef SF_SCENE_TRAVERSE_INL_H
#else
#define SF_SCENE_TRAVERSE_INL_H
#endif

#include <bit>

#include "scene/rasterizer/draw-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

/// Returns the vectors that may see a child's box in front of their certain hits.
HWY_INLINE std::uint32_t vectors_that_see(const Scratch& s, const TreeNode& node, std::uint32_t child) {
  float middle[3], half[3];
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = 0.5f * (node.bound[axis][child] + node.bound[axis + 3][child]);
    half[axis] = 0.5f * (node.bound[axis + 3][child] - node.bound[axis][child]);
  }
  const Floats mx = all(middle[0]), my = all(middle[1]), mz = all(middle[2]);
  const Floats hx = all(half[0]), hy = all(half[1]), hz = all(half[2]);
  std::uint32_t seen = 0;
  for (std::uint32_t g = 0; g < kTileVectors; g += kWidth) {
    const auto along = [&](const float(*n)[kTileVectors], const Floats& x, const Floats& y, const Floats& z) {
      return dot(load(n[0] + g), load(n[1] + g), load(n[2] + g), x, y, z);
    };
    const Floats depth = along(s.vectors.axis, mx, my, mz) - along(s.axis_size, hx, hy, hz) - load(s.axis_offset + g);
    Mask see = at_least(all(1.0001f), depth * load(s.farthest + g));
    for (int k = 0; k < 4; ++k) {
      const Floats most = along(s.vectors.plane + 3 * k, mx, my, mz) + along(s.side_size + 3 * k, hx, hy, hz);
      see = both(see, at_least(most, load(s.side_offset[k] + g)));
    }
    seen |= bits_of(see) << g;
  }
  return seen;
}

/// The corner of each box that lies farthest along a direction, or its opposite, as rows of TreeNode::bound.
struct FarCorner {
  int row[3];
  FarCorner(const float (*n)[1], bool opposite) {
    for (int axis = 0; axis < 3; ++axis) row[axis] = ((n[axis][0] >= 0.0f) != opposite ? 3 : 0) + axis;
  }
  HWY_INLINE Floats along(const float (*n)[1], const TreeNode& node) const {
    return dot(all(n[0][0]), all(n[1][0]), all(n[2][0]), load(node.bound[row[0]]), load(node.bound[row[1]]),
               load(node.bound[row[2]]));
  }
};

struct TileCorners {
  FarCorner side[4];
  FarCorner near;
  explicit TileCorners(const DirectionBoxes<1>& box)
      : side{{box.plane, false}, {box.plane + 3, false}, {box.plane + 6, false}, {box.plane + 9, false}},
        near(box.axis, true) {}
};

/// Pushes the children of a node that the tile may see, the nearest last.
/// @param limit [m] depth beyond which nothing is visible
HWY_INLINE void push_children(Scratch& s, const TileCorners& corners, const TreeNode& node, std::int32_t row,
                              float limit) {
  Mask see = at_least(corners.side[0].along(s.tile.plane, node), all(s.tile_side_offset[0]));
  for (int k = 1; k < 4; ++k)
    see = both(see, at_least(corners.side[k].along(s.tile.plane + 3 * k, node), all(s.tile_side_offset[k])));
  const Floats depth = corners.near.along(s.tile.axis, node) - all(s.tile_axis_offset);
  see = both(see, at_least(all(limit), depth));
  alignas(64) float depths[kWidth];
  store(larger(depth, all(0.0f)), depths);
  const std::size_t first = s.stack.size();
  for (std::uint32_t rest = bits_of(see); rest != 0; rest &= rest - 1) {
    const auto k = static_cast<std::uint32_t>(__builtin_ctz(rest));
    if (node.bound[0][k] > node.bound[3][k]) continue;  // unused
    const std::uint64_t entry =
        std::uint64_t{std::bit_cast<std::uint32_t>(depths[k])} << 32 | (static_cast<std::uint32_t>(row) * kWidth + k);
    s.stack.push_back(entry);
    std::size_t at = s.stack.size() - 1;
    for (; at > first && s.stack[at - 1] < entry; --at) s.stack[at] = s.stack[at - 1];
    s.stack[at] = entry;
  }
}

/// Bit mask of the tile's vectors that have beams of their own.
HWY_INLINE std::uint32_t used_vectors(const BeamTile& tile) {
  static_assert(kTileVectors == 32);
  return 0xFFFFFFFFu >> (kTileVectors - tile.used);
}

/// Returns the inverse range [1/m] below which no beam of the tile can hit a nearer surface.
HWY_INLINE float farthest_of(const Scratch& s) {
  Floats v = load(s.farthest);
  for (std::uint32_t g = kWidth; g < kTileVectors; g += kWidth) v = smaller(v, load(s.farthest + g));
  return least(v);
}
/// Returns the same as a depth [m].
HWY_INLINE float depth_limit(float farthest) { return 1.0001f / farthest; }

/// Prefetches a vector's part of a tile.
HWY_INLINE void prefetch_beams(const BeamTile& tile, std::uint32_t vector) {
  constexpr std::size_t kBoxes = sizeof(tile.vectors) / kTileVectors;
  const std::uint32_t i = kWidth * vector;
  for (const float* row : {tile.x, tile.y, tile.z}) prefetch(row + i, kWidth * sizeof(float));
  for (const double* row : {tile.dx, tile.dy, tile.dz}) prefetch(row + i, kWidth * sizeof(double));
  prefetch(reinterpret_cast<const char*>(&tile.vectors) + kBoxes * vector, kBoxes);
}

/// Prefetches what the walk comes to next.
HWY_INLINE void prefetch_next(const Scratch& s, const SurfaceTree& tree) {
  if (s.stack.empty()) return;
  const auto next = static_cast<std::uint32_t>(s.stack.back());
  const std::int32_t child = tree.nodes[next / kWidth].child[next % kWidth];
  if (child >= 0)
    prefetch(&tree.nodes[child], sizeof(TreeNode));
  else
    prefetch(&tree.leaves[~child], sizeof(TreeLeaf));
}

/// Draws a mesh of one leaf, which is rotated to the beams.
HWY_INLINE void draw_small_mesh(Scratch& s, const BeamTile& tile, const SceneMesh& mesh) {
  const LeafFaces faces = view_leaf(s, mesh.tree->leaves.front(), mesh);
  if ((faces.open | faces.edge_on) == 0) return;
  turn_to_sensor(s.leaf, mesh);
  draw_leaf(s, tile, tile, mesh, faces, used_vectors(tile), farthest_of(s));
}

/// Draws a mesh. Beams are rotated into its frame only if the tile may see a part of it.
HWY_INLINE void draw_mesh(Scratch& s, const BeamTile& tile, const SceneMesh& mesh) {
  const SurfaceTree& tree = *mesh.tree;
  if (tree.root < 0) return draw_small_mesh(s, tile, mesh);
  const std::uint32_t used = used_vectors(tile);
  float farthest = farthest_of(s);
  aim_tile(s, tile, mesh);
  const TileCorners corners(s.tile);
  float limit = depth_limit(farthest);
  s.stack.clear();
  push_children(s, corners, tree.nodes[tree.root], tree.root, limit);
  if (s.stack.empty()) return;
  aim_beams(s, tile, mesh);
  while (!s.stack.empty()) {
    const std::uint64_t entry = s.stack.back();
    s.stack.pop_back();
    if (std::bit_cast<float>(static_cast<std::uint32_t>(entry >> 32)) > limit) continue;
    const auto place = static_cast<std::uint32_t>(entry);
    const TreeNode& node = tree.nodes[place / kWidth];
    const std::int32_t child = node.child[place % kWidth];
    const std::uint32_t vectors = used & vectors_that_see(s, node, place % kWidth);
    if (vectors == 0) continue;
    if (child >= 0) {
      push_children(s, corners, tree.nodes[child], child, limit);
      prefetch_next(s, tree);
    } else {
      prefetch_next(s, tree);
      const LeafFaces faces = view_leaf(s, tree.leaves[~child], mesh);
      if ((faces.open | faces.edge_on) == 0) continue;
      draw_leaf(s, s, tile, mesh, faces, vectors, farthest);
      farthest = farthest_of(s);
      limit = depth_limit(farthest);
    }
  }
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
