// Evaluates the ranges of a tile's beams in 64 bits. Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_SCENE_RANGES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_RANGES_INL_H
#undef SF_SCENE_RANGES_INL_H
#else
#define SF_SCENE_RANGES_INL_H
#endif

#include "scene/rasterizer/draw-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

constexpr hn::CappedTag<double, kWidth> kD;
using VD = hn::Vec<decltype(kD)>;

/// Planes of a vector's beams, beam by beam: range = height / (x dx + y dy + z dz + extra).
struct BeamPlanes {
  alignas(64) double x[kWidth], y[kWidth], z[kWidth], height[kWidth], extra[kWidth], least_sine[kWidth];
};

/// Writes sixteen ranges, and the sines of the angles to the faces. @return bit mask of the beams whose angle to their
/// face is too small
template <class Row>
HWY_INLINE std::uint32_t evaluate(const BeamTile& tile, std::uint32_t first, double range_max, const Row& row,
                                  double* out, double* sines) {
  const VD most = hn::Set(kD, range_max);
  std::uint32_t grazing = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(kD)) {
    const auto plane = row(i);
    const VD along = hn::Add(hn::Mul(plane.x, hn::Load(kD, tile.dx + first + i)),
                             hn::Mul(plane.y, hn::Load(kD, tile.dy + first + i)));
    const VD sine = hn::Add(along, hn::Mul(plane.z, hn::Load(kD, tile.dz + first + i)));
    hn::Store(sine, kD, sines + i);
    hn::Store(hn::Min(hn::Div(plane.height, hn::Add(sine, plane.extra)), most), kD, out + i);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(kD, hn::Abs(sine) < plane.least_sine, bits);
    grazing |= std::uint32_t{bits[0]} << i;
  }
  return grazing;
}

struct PlaneVectors {
  VD x, y, z, height, extra, least_sine;
};

/// Ranges of sixteen beams that meet one face.
HWY_INLINE std::uint32_t evaluate_one(const BeamTile& tile, std::uint32_t first, double range_max,
                                      const SeenPlane& plane, double* out, double* sines) {
  const PlaneVectors rows{hn::Set(kD, plane.normal.x),
                          hn::Set(kD, plane.normal.y),
                          hn::Set(kD, plane.normal.z),
                          hn::Set(kD, plane.height),
                          hn::Zero(kD),
                          hn::Set(kD, plane.least_sine)};
  return evaluate(
      tile, first, range_max, [&](std::size_t) -> const PlaneVectors& { return rows; }, out, sines);
}

/// Ranges of sixteen beams that meet several faces.
template <class PlaneOf>
HWY_INLINE std::uint32_t evaluate_several(const BeamTile& tile, std::uint32_t first, double range_max,
                                          const std::uint32_t* faces, const PlaneOf& plane_of, double* out,
                                          double* sines, std::uint32_t* hits) {
  BeamPlanes rows;
  SeenPlane plane;
  for (std::uint32_t i = 0; i < kWidth; ++i) {
    const bool none = faces[i] == kNoFace;
    if (i == 0 || faces[i] != faces[i - 1])
      plane = none ? SeenPlane{.height = range_max, .owner = base::kNoHit} : plane_of(faces[i]);
    hits[i] = plane.owner;
    rows.x[i] = plane.normal.x, rows.y[i] = plane.normal.y, rows.z[i] = plane.normal.z;
    rows.height[i] = plane.height, rows.extra[i] = none ? 1.0 : 0.0, rows.least_sine[i] = plane.least_sine;
  }
  const auto row = [&](std::size_t i) {
    return PlaneVectors{hn::Load(kD, rows.x + i),      hn::Load(kD, rows.y + i),     hn::Load(kD, rows.z + i),
                        hn::Load(kD, rows.height + i), hn::Load(kD, rows.extra + i), hn::Load(kD, rows.least_sine + i)};
  };
  return evaluate(tile, first, range_max, row, out, sines);
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
