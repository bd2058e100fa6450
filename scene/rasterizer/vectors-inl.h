// Vectors of sixteen floats, whatever the machine's width. Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_SCENE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_VECTORS_INL_H
#undef SF_SCENE_VECTORS_INL_H
#else
#define SF_SCENE_VECTORS_INL_H
#endif

#include <hwy/highway.h>

#include "scene/rasterizer/scratch.h"

HWY_BEFORE_NAMESPACE();
namespace sf::scene::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Scratch = Rasterizer::Scratch;

constexpr hn::CappedTag<float, kWidth> kF;
constexpr hn::RebindToUnsigned<decltype(kF)> kU;
constexpr std::size_t kLanes = hn::MaxLanes(kF);
constexpr std::size_t kParts = kWidth / kLanes;

struct Floats {
  hn::Vec<decltype(kF)> part[kParts];
};
struct Words {
  hn::Vec<decltype(kU)> part[kParts];
};
struct Mask {
  hn::Mask<decltype(kF)> part[kParts];
};

HWY_INLINE Floats load(const float* from) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::Load(kF, from + p * kLanes);
  return out;
}
HWY_INLINE Words load(const std::uint32_t* from) {
  Words out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::Load(kU, from + p * kLanes);
  return out;
}
HWY_INLINE Floats all(float value) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::Set(kF, value);
  return out;
}
HWY_INLINE Words all(std::uint32_t value) {
  Words out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::Set(kU, value);
  return out;
}
HWY_INLINE void store(const Floats& v, float* to) {
  for (std::size_t p = 0; p < kParts; ++p) hn::Store(v.part[p], kF, to + p * kLanes);
}
HWY_INLINE void store(const Words& v, std::uint32_t* to) {
  for (std::size_t p = 0; p < kParts; ++p) hn::Store(v.part[p], kU, to + p * kLanes);
}

#define SF_BINARY(name, function)                                                          \
  HWY_INLINE Floats name(const Floats& a, const Floats& b) {                               \
    Floats out;                                                                            \
    for (std::size_t p = 0; p < kParts; ++p) out.part[p] = function(a.part[p], b.part[p]); \
    return out;                                                                            \
  }
SF_BINARY(operator+, hn::Add)
SF_BINARY(operator-, hn::Sub)
SF_BINARY(operator*, hn::Mul)
SF_BINARY(operator/, hn::Div)
SF_BINARY(larger, hn::Max)
SF_BINARY(smaller, hn::Min)
#undef SF_BINARY

HWY_INLINE Floats absolute(const Floats& a) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::Abs(a.part[p]);
  return out;
}
HWY_INLINE Floats root(const Floats& a) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::Sqrt(a.part[p]);
  return out;
}
/// a b + c, rounded once or twice.
HWY_INLINE Floats muladd(const Floats& a, const Floats& b, const Floats& c) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::MulAdd(a.part[p], b.part[p], c.part[p]);
  return out;
}
/// a b - c
HWY_INLINE Floats mulsub(const Floats& a, const Floats& b, const Floats& c) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::MulSub(a.part[p], b.part[p], c.part[p]);
  return out;
}
/// a with the sign changed where b is negative.
HWY_INLINE Floats turned(const Floats& a, const Floats& b) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::Xor(a.part[p], hn::And(b.part[p], hn::SignBit(kF)));
  return out;
}
HWY_INLINE Mask greater(const Floats& a, const Floats& b) {
  Mask out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = a.part[p] > b.part[p];
  return out;
}
HWY_INLINE Mask at_least(const Floats& a, const Floats& b) {
  Mask out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = a.part[p] >= b.part[p];
  return out;
}
HWY_INLINE Mask both(const Mask& a, const Mask& b) {
  Mask out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::And(a.part[p], b.part[p]);
  return out;
}
HWY_INLINE Floats select(const Mask& m, const Floats& yes, const Floats& no) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::IfThenElse(m.part[p], yes.part[p], no.part[p]);
  return out;
}
HWY_INLINE Words select(const Mask& m, const Words& yes, const Words& no) {
  Words out;
  for (std::size_t p = 0; p < kParts; ++p)
    out.part[p] = hn::IfThenElse(hn::RebindMask(kU, m.part[p]), yes.part[p], no.part[p]);
  return out;
}
HWY_INLINE Floats select_or_zero(const Mask& m, const Floats& yes) {
  Floats out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::IfThenElseZero(m.part[p], yes.part[p]);
  return out;
}
HWY_INLINE std::uint32_t bits_of(const Mask& m) {
  std::uint32_t out = 0;
  for (std::size_t p = 0; p < kParts; ++p) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kF, m.part[p], bytes);
    out |= (std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8) << (p * kLanes);
  }
  return out;
}
HWY_INLINE float least(const Floats& a) {
  auto v = a.part[0];
  for (std::size_t p = 1; p < kParts; ++p) v = hn::Min(v, a.part[p]);
  return hn::GetLane(hn::MinOfLanes(kF, v));
}
HWY_INLINE Floats dot(const Floats& x, const Floats& y, const Floats& z, const Floats& a, const Floats& b,
                      const Floats& c) {
  return muladd(x, a, muladd(y, b, z * c));
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
