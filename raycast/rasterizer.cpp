#include "raycast/rasterizer.h"

#include <algorithm>

#include "raycast/rasterizer/scratch.h"

#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raycast/rasterizer.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h: the code that is compiled per instruction set.
#include "raycast/rasterizer/decide-inl.h"
#include "raycast/rasterizer/ranges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sf::raycast::HWY_NAMESPACE {

void scan(Scratch& s, const Projection& p, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene) {
  s.begin(pattern.beams);
  s.horizon = static_cast<float>(std::min(view.range_max, scene.crowd_horizon));
  const auto inverse = static_cast<float>(1.0 / std::min(view.range_max, scene.crowd_horizon));
  for (std::uint32_t j = 0; j < pattern.beams; j += lanes()) {
    store(constant(inverse * (1.0f - 1e-6f)), &s.near_low[j]);
    store(constant(inverse * (1.0f + 1e-6f)), &s.near_high[j]);
    store(constant(0.0f), &s.others[j]);
    hn::StoreU(hn::Set(kI, -1), kI, &s.nearest_row[j]);
  }
  if (scene.crowd_index != nullptr)
    draw_indexed_crowd(s, view, pattern, scene);
  else
    project_cell(s, p, pattern, scene.crowd, Draw{s, pattern});
  project_cell(s, p, pattern, scene.walls, Draw{s, pattern});
  s.order.clear();
  if (!scene.crowd_members.empty()) s.horizon = std::min(s.horizon, horizon_of(s, pattern));
  if (scene.movers != nullptr) rasterize_movers(s, p, view, pattern, scene);
}

/// @return true if any beam grazes a surface
bool scan_all(Scratch& s, const ScanView& view, const ScanPattern& pattern, const ScanScene& scene,
              const ScanOutput& out) {
  if (pattern.beams <= kMaxExactBeams) return intersect_all_beams(s, view, pattern, scene, out);
  const Projection p = projection_of(view, pattern);
  scan(s, p, view, pattern, scene);
  return write_certain_ranges(s, view, pattern, scene, out) &&
         intersect_uncertain_beams(s, p, view, pattern, scene, out);
}

const char* instructions() { return hwy::TargetName(HWY_TARGET); }

}  // namespace sf::raycast::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sf::raycast {

HWY_EXPORT(scan_all);
HWY_EXPORT(instructions);

void Rasterizer::Scratch::begin(std::uint32_t beams) {
  const std::size_t padded = std::size_t{beams} + 2 * kBlock;
  if (near_low.size() < padded) {
    near_low.resize(padded), near_high.resize(padded), others.resize(padded), nearest_row.resize(padded);
  }
  ends.resize(beams / 64 + 1);
  uncertain.resize(beams / 64 + 1);
}

Rasterizer::Rasterizer() : scratch_(std::make_unique<Scratch>()) {}
Rasterizer::~Rasterizer() = default;
Rasterizer::Rasterizer(Rasterizer&&) noexcept = default;

const ScanCounts& Rasterizer::counts() const { return scratch_->counts; }

bool Rasterizer::scan(const ScanView& view, const ScanPattern& pattern, const ScanScene& scene, const ScanOutput& out) {
  return HWY_DYNAMIC_DISPATCH(scan_all)(*scratch_, view, pattern, scene, out);
}

const char* vector_instructions() { return HWY_DYNAMIC_DISPATCH(instructions)(); }

}  // namespace sf::raycast
#endif
