// Draws faces into vectors of beams. Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_SCENE_DRAW_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_DRAW_INL_H
#undef SF_SCENE_DRAW_INL_H
#else
#define SF_SCENE_DRAW_INL_H
#endif

#include "scene/rasterizer/leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

/// Beams of one vector.
struct Beams {
  Floats x, y, z, low, high, others;
  Words face;
};

/// @param from has the directions x, y and z of the beams: `s`, or the tile itself in the sensor's frame
template <class Directions>
HWY_INLINE Beams load_beams(const Directions& from, const Scratch& s, std::uint32_t vector) {
  const std::uint32_t i = kWidth * vector;
  return {load(from.x + i), load(from.y + i),   load(from.z + i), load(s.low + i),
          load(s.high + i), load(s.others + i), load(s.face + i)};
}

HWY_INLINE void store_beams(Scratch& s, std::uint32_t vector, const Beams& b) {
  const std::uint32_t i = kWidth * vector;
  store(b.low, s.low + i), store(b.high, s.high + i), store(b.others, s.others + i), store(b.face, s.face + i);
  s.farthest[vector] = least(b.low);
}

/// Draws face `k` of the leaf.
/// @param covers true: it certainly covers all beams  @param sign -1 turns it around
template <bool covers>
HWY_INLINE void draw(const LeafView& view, std::uint32_t k, float sign, std::uint32_t face, Beams& b) {
  const Floats w = dot(all(view.inverse[0][k]), all(view.inverse[1][k]), all(view.inverse[2][k]), b.x, b.y, b.z);
  const Floats slack = all(view.slack[k]);
  const Floats high = muladd(w, all(view.above[k]), slack), low = mulsub(w, all(view.below[k]), slack);
  Mask nearest = greater(low, b.low);
  if constexpr (covers) {
    b.others = larger(b.others, select(nearest, b.high, high));
  } else {
    const auto side = [&](int e) {
      return dot(all(view.edge[3 * e][k] * sign), all(view.edge[3 * e + 1][k] * sign),
                 all(view.edge[3 * e + 2][k] * sign), b.x, b.y, b.z);
    };
    const Floats inside = smaller(smaller(side(0), side(1)), smaller(side(2), side(3)));
    nearest = both(nearest, greater(inside, all(view.edge_error[k])));
    const Mask possible = at_least(inside, all(-view.edge_error[k]));
    b.others = larger(b.others, select(nearest, b.high, select_or_zero(possible, high)));
  }
  b.low = select(nearest, low, b.low), b.high = select(nearest, high, b.high);
  b.face = select(nearest, all(face), b.face);
}

/// Smallest values of the four edges' e . d over boxes of directions: their extents' smallest ends.
template <class Edge>
HWY_INLINE Extent inside_of(const Edge& edge, const Floats (&box)[9]) {
  Extent e = extent(edge(0), edge(1), edge(2), box);
  for (int k = 3; k < 12; k += 3) {
    const Extent next = extent(edge(k), edge(k + 1), edge(k + 2), box);
    e = {smaller(e.low, next.low), smaller(e.high, next.high)};
  }
  return e;
}

/// Returns the faces that may cover directions c + a U + b V of a box: all edges allow one a. Edge by edge, most faces
/// beside a row of beams would be left.
/// @param error of e . d
HWY_INLINE Mask may_cover_row(const float (&edges)[12][kWidth], const Floats& error, const Floats (&box)[9]) {
  Floats from = all(-1.0f), to = all(1.0f);
  for (int k = 0; k < 12; k += 3) {
    const Floats x = load(edges[k]), y = load(edges[k + 1]), z = load(edges[k + 2]);
    const Floats rise = dot(x, y, z, box[3], box[4], box[5]);
    const Floats high = dot(x, y, z, box[0], box[1], box[2]) + absolute(dot(x, y, z, box[6], box[7], box[8])) + error;
    const Floats end = high / larger(absolute(rise), all(1e-30f));  // the edge is there along U, or against it
    const Mask up = at_least(rise, all(0.0f));
    from = larger(from, select(up, all(0.0f) - end, from)), to = smaller(to, select(up, to, end));
  }
  return at_least(to + all(1e-5f), from);
}

/// Draws the faces of a leaf in one group of sixteen vectors.
template <class Directions>
class LeafDrawing {
 public:
  /// @param from has the beams and boxes in the frame of Scratch::leaf: `s`, or `tile` in the sensor's frame
  LeafDrawing(Scratch& s, const Directions& from, const BeamTile& tile, const SceneMesh& mesh)
      : s_(s),
        from_(from),
        view_(s.leaf),
        planes_(mesh.tree->planes.data()),
        first_face_(mesh.first_face),
        longest_(tile.longest) {}

  /// Returns those of sixteen faces that a box of directions may see. @param farthest [1/m] nearest certain hit
  /// @tparam row true: the box of a vector
  template <bool row>
  HWY_INLINE std::uint32_t faces_seen(const Floats (&box)[9], float farthest) const {
    const Floats error = load(view_.edge_error) * all(2.0f * longest_);
    Mask inside;
    if constexpr (row)
      inside = may_cover_row(view_.edge, error, box);
    else
      inside = at_least(inside_of([&](int k) { return load(view_.edge[k]); }, box).high + error, all(0.0f));
    const Floats nearest = extent(load(view_.inverse[0]), load(view_.inverse[1]), load(view_.inverse[2]), box).high;
    const Floats high =
        muladd(larger(nearest, all(0.0f)), load(view_.above) + all(1e-5f), load(view_.slack) * all(longest_));
    return bits_of(both(inside, at_least(high, all(farthest))));
  }

  /// All faces in one vector.
  HWY_INLINE void draw_vector(std::uint32_t v, std::uint32_t faces) {
    Floats box[9];
    for (int i = 0; i < 9; ++i) box[i] = all(from_.vectors.box[i][v]);
    faces &= faces_seen<true>(box, s_.farthest[v]);
    if (faces == 0) return;
    Beams beams = load_beams(from_, s_, v);
    for (; faces != 0; faces &= faces - 1) {
      const auto k = static_cast<std::uint32_t>(__builtin_ctz(faces));
      const std::uint32_t face = list_face(k, 1u << v);
      draw<false>(view_, k, 1.0f, face, beams);
    }
    store_beams(s_, v, beams);
  }

  /// One face in the vectors of `wanted` from `g` on.
  HWY_INLINE void draw_face(std::uint32_t k, std::uint32_t g, std::uint32_t wanted, const Floats (&box)[9]) {
    const Extent inside = inside_of([&](int i) { return all(view_.edge[i][k]); }, box);
    const Floats nearest =
        extent(all(view_.inverse[0][k]), all(view_.inverse[1][k]), all(view_.inverse[2][k]), box).high;
    const Floats high = muladd(larger(nearest, all(0.0f)), all(view_.above[k] + 1e-5f), all(view_.slack[k] * longest_));
    const Floats error = all(view_.edge_error[k] * (2.0f * longest_));
    std::uint32_t seen =
        wanted & bits_of(both(at_least(inside.high + error, all(0.0f)), at_least(high, load(s_.farthest + g))));
    if (seen == 0) return;
    const std::uint32_t covered = bits_of(greater(inside.low, error)), face = list_face(k, seen << g);
    for (; seen != 0; seen &= seen - 1) {
      const auto v = static_cast<std::uint32_t>(__builtin_ctz(seen));
      Beams beams = load_beams(from_, s_, g + v);
      if ((covered >> v & 1) != 0)
        draw<true>(view_, k, 1.0f, face, beams);
      else
        draw<false>(view_, k, 1.0f, face, beams);
      store_beams(s_, g + v, beams);
    }
  }

  /// A face seen edge-on, in either orientation.
  HWY_INLINE void draw_edge_on(std::uint32_t k, std::uint32_t vectors) {
    const std::uint32_t face = list_face(k, vectors);
    for (; vectors != 0; vectors &= vectors - 1) {
      const auto v = static_cast<std::uint32_t>(__builtin_ctz(vectors));
      Beams beams = load_beams(from_, s_, v);
      draw<false>(view_, k, 1.0f, face, beams), draw<false>(view_, k, -1.0f, face, beams);
      store_beams(s_, v, beams);
    }
  }

 private:
  /// Lists a face that is drawn, and prefetches its plane. @return its number
  HWY_INLINE std::uint32_t list_face(std::uint32_t k, std::uint32_t vectors) {
    const std::uint32_t row = view_.face[k];
    prefetch(planes_ + row, sizeof(Plane));
    s_.drawn.push_back({first_face_ + row, vectors});
    return first_face_ + row;
  }

  Scratch& s_;
  const Directions& from_;
  const LeafView& view_;
  const Plane* planes_;
  std::uint32_t first_face_;
  float longest_;  ///< BeamTile::longest
};

/// Draws a leaf's faces. @param from as LeafDrawing's  @param vectors bit mask of the vectors that may see the leaf
template <class Directions>
HWY_INLINE void draw_leaf(Scratch& s, const Directions& from, const BeamTile& tile, const SceneMesh& mesh,
                          const LeafFaces& faces, std::uint32_t vectors, float farthest) {
  LeafDrawing drawing(s, from, tile, mesh);
  std::uint32_t open = faces.open;
  if (__builtin_popcount(vectors) > 2) {  // the tile's box first
    Floats box[9];
    for (int i = 0; i < 9; ++i) box[i] = all(from.tile.box[i][0]);
    open &= drawing.template faces_seen<false>(box, farthest);
  }
  for (std::uint32_t g = 0; g < kTileVectors && open != 0; g += kWidth) {
    const std::uint32_t wanted = vectors >> g & 0xFFFFu;
    if (wanted == 0) continue;
    const int vector_count = __builtin_popcount(wanted);
    if (vector_count <= 2 || vector_count < __builtin_popcount(open)) {
      for (std::uint32_t rest = wanted; rest != 0; rest &= rest - 1)
        drawing.draw_vector(g + static_cast<std::uint32_t>(__builtin_ctz(rest)), open);
    } else {
      Floats box[9];
      for (int i = 0; i < 9; ++i) box[i] = load(from.vectors.box[i] + g);
      for (std::uint32_t rest = open; rest != 0; rest &= rest - 1)
        drawing.draw_face(static_cast<std::uint32_t>(__builtin_ctz(rest)), g, wanted, box);
    }
  }
  for (std::uint32_t rest = faces.edge_on; rest != 0; rest &= rest - 1)
    drawing.draw_edge_on(static_cast<std::uint32_t>(__builtin_ctz(rest)), vectors);
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
