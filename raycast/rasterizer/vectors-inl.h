// Vector types of a scan: as wide as the machine's vectors, but at most one block of segments. Compiled once per
// instruction set (hwy/foreach_target.h).

#if defined(SF_RAYCAST_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_RAYCAST_VECTORS_INL_H
#undef SF_RAYCAST_VECTORS_INL_H
#else
#define SF_RAYCAST_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "raycast/rasterizer/scratch.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Scratch = Rasterizer::Scratch;

constexpr hn::CappedTag<float, kBlock> kF;
using F = decltype(kF);
using VF = hn::Vec<F>;
using MF = hn::Mask<F>;
constexpr hn::RebindToSigned<F> kI;
constexpr hn::RebindToUnsigned<F> kU;
constexpr hn::ScalableTag<double> kD;
using VD = hn::Vec<decltype(kD)>;
constexpr hn::Rebind<std::uint32_t, decltype(kD)> kModels;  // one per range
constexpr hn::Rebind<std::int64_t, decltype(kD)> kRows;     // one per range

inline std::uint32_t lanes() { return static_cast<std::uint32_t>(hn::Lanes(kF)); }
inline VF constant(float value) { return hn::Set(kF, value); }
inline VF load(const float* p) { return hn::LoadU(kF, p); }
inline void store(VF v, float* p) { hn::StoreU(v, kF, p); }

inline std::uint32_t bits_of(MF mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kF, mask, bytes);
  return static_cast<std::uint32_t>(bytes[0]) | static_cast<std::uint32_t>(bytes[1]) << 8;
}

/// Computes the bearing [rad] of (x, y), to 1e-6, by Abramowitz and Stegun 4.4.49, and the inverse of max(|x|, |y|).
HWY_INLINE VF bearing_of(VF y, VF x, VF& inverse) {
  const VF across = hn::Abs(y), along = hn::Abs(x);
  const VF larger = hn::Max(hn::Max(along, across), constant(1e-30f));
  inverse = constant(1.0f) / larger;
  const VF q = hn::Min(along, across) * inverse;
  const VF z = q * q;
  VF p = constant(0.0028662257f) * z - constant(0.0161657367f);
  for (const float c :
       {0.0429096138f, -0.0752896400f, 0.1065626393f, -0.1420889944f, 0.1999355085f, -0.3333314528f, 1.0f})
    p = p * z + constant(c);
  p = p * q;
  p = hn::IfThenElse(across > along, constant(1.57079637f) - p, p);
  p = hn::IfThenElse(x < constant(0.0f), constant(3.14159274f) - p, p);
  return hn::CopySignToAbs(p, y);
}

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
