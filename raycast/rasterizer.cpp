#include "raycast/rasterizer.h"

#include <algorithm>

#include "raycast/rasterizer/scratch.h"

#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/rasterizer.cpp"
#include <hwy/foreach_target.h>
// Behind it: what is compiled for each.
#include "raycast/rasterizer/answers-inl.h"
#include "raycast/rasterizer/doubts-inl.h"
#include "raycast/rasterizer/movers-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

void scan(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene) {
  s.begin(pattern.beams);
  const auto inverse = static_cast<float>(1.0 / view.range_max);
  for (std::uint32_t j = 0; j < pattern.beams; j += lanes()) {
    store(constant(inverse * (1.0f - 1e-6f)), &s.near_low[j]);
    store(constant(inverse * (1.0f + 1e-6f)), &s.near_high[j]);
    store(constant(0.0f), &s.others[j]);
    hn::StoreU(hn::Set(kI, -1), kI, &s.winner[j]);
  }
  const Projection p = projection_of(view, pattern);
  draw_walls(s, p, view, pattern, scene);
  if (scene.movers != nullptr) draw_movers(s, p, view, pattern, scene);
}

/// @return whether any beam is in doubt
bool scan_all(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
              const ScanOutput& out) {
  scan(s, view, pattern, scene);
  return answer(s, view, pattern, scene, out);
}

const char* instructions() { return hwy::TargetName(HWY_TARGET); }

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sf::raycast {

HWY_EXPORT(scan_all);
HWY_EXPORT(decide_beam);
HWY_EXPORT(instructions);

void Rasterizer::Scratch::begin(std::uint32_t beams) {
  const std::size_t padded = std::size_t{beams} + 2 * kBlock;
  if (near_low.size() < padded) {
    near_low.resize(padded), near_high.resize(padded), others.resize(padded), winner.resize(padded);
  }
  ends.resize(beams / 64 + 1);
  doubts.resize(beams / 64 + 1);
  live.clear();
  used = 0;
}

void Rasterizer::Scratch::reserve(std::uint32_t more) {
  const std::size_t needed = std::size_t{used} + more;
  if (a.size() >= needed) return;
  const std::size_t room = 2 * needed + 256;
  for (std::vector<float>* v : {&a, &b, &error, &low_any, &high_any, &low_sure, &high_sure}) v->resize(room);
  first.resize(room), last.resize(room), row.resize(room);
}

Rasterizer::Rasterizer() : scratch_(std::make_unique<Scratch>()) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;

const ScanCounts& Rasterizer::counts() const { return scratch_->counts; }

namespace {

/// Answers beam `i` in 64 bits, against all. @return whether it grazes
bool answer_beam(Rasterizer::Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
                 std::size_t i, const ScanOutput& out) {
  const base::Vec2 d = direction_of(view, pattern, i);
  Decision best = HWY_DYNAMIC_DISPATCH(decide_beam)(s, view, scene, d);
  const bool grazes = best.grazes(static_cast<float>(view.least_sine));
  if (view.single && best.id != SF_NO_HIT) {
    const float t = measure_single(scene.exact[best.id], view.origin, d, static_cast<float>(view.range_max));
    if (t >= 0.0f) best.range = std::min(static_cast<double>(t), view.range_max);
  }
  out.ranges[i] = std::max(best.range, view.range_min);
  out.models[i] = best.id == SF_NO_HIT ? SF_NO_HIT : scene.models[best.id];
  out.grazes[i] = grazes ? 1 : 0;
  return grazes;
}

}  // namespace

bool Rasterizer::scan(const ScanView& view, const ScanPattern& pattern, const ScanScene& scene, const ScanOutput& out) {
  Scratch& s = *scratch_;
  bool grazes = false;
  if (pattern.beams <= kFewBeams) {
    for (std::size_t i = 0; i < pattern.beams; ++i) grazes |= answer_beam(s, view, pattern, scene, i, out);
    return grazes;
  }
  if (!HWY_DYNAMIC_DISPATCH(scan_all)(s, view, pattern, scene, out)) return false;
  std::fill_n(out.grazes, pattern.beams, std::uint8_t{0});
  for (std::size_t w = 0; w < s.doubts.size(); ++w)
    for (std::uint64_t open = s.doubts[w]; open != 0; open &= open - 1) {
      const std::size_t i = 64 * w + static_cast<std::size_t>(__builtin_ctzll(open));
      grazes |= answer_beam(s, view, pattern, scene, i, out);
      ++s.counts.doubts;
    }
  return grazes;
}

const char* vector_instructions() { return HWY_DYNAMIC_DISPATCH(instructions)(); }

}  // namespace sf::raycast
#endif
