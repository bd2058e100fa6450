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

HWY_INLINE std::uint32_t double_bits_of(const hn::Mask<decltype(kD)>& m) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kD, m, bytes);
  return bytes[0];
}

HWY_INLINE bool are_all(const std::uint32_t* faces, std::uint32_t face) {
  return bits_of(equal(load(faces), all(face))) == (1u << kWidth) - 1;
}

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
    grazing |= double_bits_of(hn::Abs(sine) < plane.least_sine) << i;
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
  constexpr std::size_t kLanesD = hn::MaxLanes(kD);
  const VD zero = hn::Zero(kD);
  PlaneVectors rows[kWidth / kLanesD];
  for (PlaneVectors& row : rows) row = {zero, zero, zero, zero, zero, zero};
  Words owners = all(base::kNoHit);
  const SeenPlane nothing{.height = range_max, .owner = base::kNoHit};
  for (std::uint32_t rest = (1u << kWidth) - 1; rest != 0;) {
    const std::uint32_t face = faces[__builtin_ctz(rest)];
    const bool none = face == kNoFace;
    const SeenPlane& plane = none ? nothing : plane_of(face);
    const Mask meets = equal(load(faces), all(face));
    const std::uint32_t same = bits_of(meets);
    rest &= ~same;
    owners = select(meets, all(plane.owner), owners);
    for (std::size_t p = 0; p < kWidth / kLanesD; ++p) {
      const auto mask = hn::LoadMaskBits(kD, bytes_of(same >> (p * kLanesD)).data());
      const auto put = [&](double value, VD& to) { to = hn::IfThenElse(mask, hn::Set(kD, value), to); };
      put(plane.normal.x, rows[p].x), put(plane.normal.y, rows[p].y), put(plane.normal.z, rows[p].z);
      put(plane.height, rows[p].height), put(none ? 1.0 : 0.0, rows[p].extra),
          put(plane.least_sine, rows[p].least_sine);
    }
  }
  store(owners, hits);
  return evaluate(
      tile, first, range_max, [&](std::size_t i) -> const PlaneVectors& { return rows[i / kLanesD]; }, out, sines);
}

/// Turns sixteen ranges and hits into those of depths: ScanOutput::depth_max.
HWY_INLINE void to_depths(const BeamTile& tile, std::uint32_t first, double depth_max, double* ranges,
                          std::uint32_t* hits) {
  const VD most = hn::Set(kD, depth_max);
  std::uint32_t beyond = 0;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(kD)) {
    const VD depth = hn::Mul(hn::Load(kD, ranges + i), hn::Load(kD, tile.dx + first + i));
    beyond |= double_bits_of(depth >= most) << i;
    hn::Store(hn::Min(depth, most), kD, ranges + i);
  }
  for (; beyond != 0; beyond &= beyond - 1) hits[__builtin_ctz(beyond)] = base::kNoHit;
}

/// A face for ranges in 32 bits.
struct SinglePlane {
  float x = 0.0f, y = 0.0f, z = 0.0f;  ///< n / h
  float height = 0.0f, least_sine = 0.0f;
};

inline SinglePlane single_plane(const SeenPlane& plane) {
  const glm::dvec3 a = plane.normal * (1.0 / plane.height);
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z), static_cast<float>(plane.height),
          std::max(80.0f * kRounding, 1.01f * static_cast<float>(plane.least_sine))};
}

struct SingleVectors {
  Floats x, y, z, height, least_sine;
};

/// Sets the planes of some beams.
HWY_INLINE void put(const Mask& beams, const SinglePlane& plane, SingleVectors& to) {
  const auto put_one = [&](float value, Floats& row) { row = select(beams, all(value), row); };
  put_one(plane.x, to.x), put_one(plane.y, to.y), put_one(plane.z, to.z);
  put_one(plane.height, to.height), put_one(plane.least_sine, to.least_sine);
}

/// Writes sixteen ranges that are measured in 32 bits, range_max for beams without a face, and the sines of the angles
/// to the faces. @return bit mask of the beams whose error is within kSingleRangeError
HWY_INLINE std::uint32_t evaluate_single(const BeamTile& tile, std::uint32_t first, double range_max,
                                         const SingleVectors& plane, double* out, double* sines) {
  const Floats inverse =
      (plane.x * load(tile.x + first) + plane.y * load(tile.y + first)) + plane.z * load(tile.z + first);
  const Floats range = all(1.0f) / inverse, sine = plane.height * inverse, steep = absolute(sine);
  alignas(64) float short_ranges[kWidth], short_sines[kWidth];
  store(range, short_ranges), store(sine, short_sines);
  constexpr hn::Rebind<float, decltype(kD)> kHalf;
  for (std::size_t i = 0; i < kWidth; i += hn::Lanes(kD)) {
    hn::Store(hn::Min(hn::PromoteTo(kD, hn::Load(kHalf, short_ranges + i)), hn::Set(kD, range_max)), kD, out + i);
    hn::Store(hn::PromoteTo(kD, hn::Load(kHalf, short_sines + i)), kD, sines + i);
  }
  const Floats error = range * all(10.0f * kRounding), most = all(0.999f * static_cast<float>(kSingleRangeError));
  return bits_of(
      both(both(greater(inverse, all(0.0f)), at_least(steep, plane.least_sine)), at_least(most * steep, error)));
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
