// Vectors of sixteen floats on machines of any vector width. Compiled once per instruction set (hwy/foreach_target.h).

#if defined(SF_SCENE_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SF_SCENE_VECTORS_INL_H
#undef SF_SCENE_VECTORS_INL_H
#else
#define SF_SCENE_VECTORS_INL_H
#endif

#include <hwy/highway.h>
#include <array>

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
constexpr hn::RebindToSigned<decltype(kF)> kI;
struct Ints {
  hn::Vec<decltype(kI)> part[kParts];
};

/// Defines a function of vectors by its result in part `p`.
#define SF_BY_PARTS(Result, name, parameters, result)                \
  HWY_INLINE Result name parameters {                                \
    Result out;                                                      \
    for (std::size_t p = 0; p < kParts; ++p) out.part[p] = (result); \
    return out;                                                      \
  }
SF_BY_PARTS(Floats, load, (const float* from), hn::Load(kF, from + p * kLanes))
SF_BY_PARTS(Words, load, (const std::uint32_t* from), hn::Load(kU, from + p * kLanes))
SF_BY_PARTS(Floats, all, (float value), hn::Set(kF, value))
SF_BY_PARTS(Words, all, (std::uint32_t value), hn::Set(kU, value))
SF_BY_PARTS(Floats, operator+, (const Floats& a, const Floats& b), hn::Add(a.part[p], b.part[p]))
SF_BY_PARTS(Floats, operator-, (const Floats& a, const Floats& b), hn::Sub(a.part[p], b.part[p]))
SF_BY_PARTS(Floats, operator*, (const Floats& a, const Floats& b), hn::Mul(a.part[p], b.part[p]))
SF_BY_PARTS(Floats, operator/, (const Floats& a, const Floats& b), hn::Div(a.part[p], b.part[p]))
SF_BY_PARTS(Floats, larger, (const Floats& a, const Floats& b), hn::Max(a.part[p], b.part[p]))
SF_BY_PARTS(Floats, smaller, (const Floats& a, const Floats& b), hn::Min(a.part[p], b.part[p]))
SF_BY_PARTS(Floats, absolute, (const Floats& a), hn::Abs(a.part[p]))
SF_BY_PARTS(Floats, root, (const Floats& a), hn::Sqrt(a.part[p]))
/// a b + c and a b - c, rounded once or twice.
SF_BY_PARTS(Floats, muladd, (const Floats& a, const Floats& b, const Floats& c),
            hn::MulAdd(a.part[p], b.part[p], c.part[p]))
SF_BY_PARTS(Floats, mulsub, (const Floats& a, const Floats& b, const Floats& c),
            hn::MulSub(a.part[p], b.part[p], c.part[p]))
/// c - a b, rounded once or twice.
SF_BY_PARTS(Floats, mulless, (const Floats& a, const Floats& b, const Floats& c),
            hn::NegMulAdd(a.part[p], b.part[p], c.part[p]))
/// a with the sign changed where b is negative.
SF_BY_PARTS(Floats, turned, (const Floats& a, const Floats& b), hn::Xor(a.part[p], hn::And(b.part[p], hn::SignBit(kF))))
SF_BY_PARTS(Mask, greater, (const Floats& a, const Floats& b), a.part[p] > b.part[p])
SF_BY_PARTS(Mask, at_least, (const Floats& a, const Floats& b), a.part[p] >= b.part[p])
SF_BY_PARTS(Mask, both, (const Mask& a, const Mask& b), hn::And(a.part[p], b.part[p]))
SF_BY_PARTS(Floats, select, (const Mask& m, const Floats& yes, const Floats& no),
            hn::IfThenElse(m.part[p], yes.part[p], no.part[p]))
SF_BY_PARTS(Words, select, (const Mask& m, const Words& yes, const Words& no),
            hn::IfThenElse(hn::RebindMask(kU, m.part[p]), yes.part[p], no.part[p]))
SF_BY_PARTS(Floats, select_or_zero, (const Mask& m, const Floats& yes), hn::IfThenElseZero(m.part[p], yes.part[p]))
SF_BY_PARTS(Mask, either, (const Mask& a, const Mask& b), hn::Or(a.part[p], b.part[p]))
/// a and not b.
SF_BY_PARTS(Mask, without, (const Mask& a, const Mask& b), hn::AndNot(b.part[p], a.part[p]))

SF_BY_PARTS(Ints, all, (std::int32_t value), hn::Set(kI, value))
SF_BY_PARTS(Ints, load, (const std::int32_t* from), hn::Load(kI, from + p * kLanes))
SF_BY_PARTS(Ints, operator+, (const Ints& a, const Ints& b), hn::Add(a.part[p], b.part[p]))
SF_BY_PARTS(Ints, operator-, (const Ints& a, const Ints& b), hn::Sub(a.part[p], b.part[p]))
SF_BY_PARTS(Ints, operator*, (const Ints& a, const Ints& b), hn::Mul(a.part[p], b.part[p]))
SF_BY_PARTS(Ints, operator&, (const Ints& a, const Ints& b), hn::And(a.part[p], b.part[p]))
SF_BY_PARTS(Ints, operator<<, (const Ints& a, const Ints& bits), a.part[p] << bits.part[p])
SF_BY_PARTS(Ints, operator>>, (const Ints& a, const Ints& bits), a.part[p] >> bits.part[p])
SF_BY_PARTS(Ints, larger, (const Ints& a, const Ints& b), hn::Max(a.part[p], b.part[p]))
SF_BY_PARTS(Ints, smaller, (const Ints& a, const Ints& b), hn::Min(a.part[p], b.part[p]))
SF_BY_PARTS(Mask, greater, (const Ints& a, const Ints& b), hn::RebindMask(kF, a.part[p] > b.part[p]))
SF_BY_PARTS(Mask, equal, (const Ints& a, const Ints& b), hn::RebindMask(kF, a.part[p] == b.part[p]))
SF_BY_PARTS(Mask, equal, (const Words& a, const Words& b), hn::RebindMask(kF, a.part[p] == b.part[p]))
SF_BY_PARTS(Ints, select, (const Mask& m, const Ints& yes, const Ints& no),
            hn::IfThenElse(hn::RebindMask(kI, m.part[p]), yes.part[p], no.part[p]))
SF_BY_PARTS(Floats, floats_of, (const Ints& a), hn::ConvertTo(kF, a.part[p]))
SF_BY_PARTS(Ints, bits_of_floats, (const Floats& a), hn::BitCast(kI, a.part[p]))
SF_BY_PARTS(Floats, floats_with_bits, (const Ints& a), hn::BitCast(kF, a.part[p]))
SF_BY_PARTS(Ints, lane_numbers, (), hn::Iota(kI, static_cast<std::int32_t>(p* kLanes)))
SF_BY_PARTS(Floats, gather, (const float* from, const Ints& rows), hn::GatherIndex(kF, from, rows.part[p]))
#undef SF_BY_PARTS

HWY_INLINE void store(const Floats& v, float* to) {
  for (std::size_t p = 0; p < kParts; ++p) hn::Store(v.part[p], kF, to + p * kLanes);
}
HWY_INLINE void store(const Words& v, std::uint32_t* to) {
  for (std::size_t p = 0; p < kParts; ++p) hn::Store(v.part[p], kU, to + p * kLanes);
}
HWY_INLINE void store(const Ints& v, std::int32_t* to) {
  for (std::size_t p = 0; p < kParts; ++p) hn::Store(v.part[p], kI, to + p * kLanes);
}
HWY_INLINE bool none(const Mask& m) {
  bool out = true;
  for (std::size_t p = 0; p < kParts; ++p) out = out && hn::AllFalse(kF, m.part[p]);
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
/// The first bits, for hn::LoadMaskBits.
HWY_INLINE std::array<std::uint8_t, 8> bytes_of(std::uint32_t bits) {
  return {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8)};
}
HWY_INLINE Mask mask_of(std::uint32_t bits) {
  Mask out;
  for (std::size_t p = 0; p < kParts; ++p) out.part[p] = hn::LoadMaskBits(kF, bytes_of(bits >> (p * kLanes)).data());
  return out;
}
/// Loads sixteen pairs that follow each other.
HWY_INLINE void load_pairs(const float* from, Floats& first, Floats& second) {
  for (std::size_t p = 0; p < kParts; ++p)
    hn::LoadInterleaved2(kF, from + 2 * p * kLanes, first.part[p], second.part[p]);
}
/// Nearest integer to v, plus kNearestBits; |v| < 2^22.
constexpr std::int32_t kNearestBits = 0x4B400000;
HWY_INLINE Ints nearest_bits(const Floats& v) { return bits_of_floats(v + all(0x1.8p23f)); }
/// Largest integer up to v, or its neighbour where rounding decides; |v| < 2^22.
HWY_INLINE Ints floor_near(const Floats& v) { return nearest_bits(v - all(0.5f)) - all(kNearestBits); }
HWY_INLINE float least(const Floats& a) {
  auto v = a.part[0];
  for (std::size_t p = 1; p < kParts; ++p) v = hn::Min(v, a.part[p]);
  return hn::GetLane(hn::MinOfLanes(kF, v));
}
HWY_INLINE Floats dot(const Floats& x, const Floats& y, const Floats& z, const Floats& a, const Floats& b,
                      const Floats& c) {
  return muladd(x, a, muladd(y, b, z * c));
}

HWY_INLINE void prefetch(const void* from, std::size_t bytes) {
  const auto* const first = static_cast<const char*>(from);
  for (std::size_t i = 0; i < bytes; i += 64) __builtin_prefetch(first + i);
  if (bytes % 64 != 0) __builtin_prefetch(first + bytes - 1);  // may be in a further line
}

}  // namespace sf::scene::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
