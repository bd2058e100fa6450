#include "raycast/cast_results.h"

#include <algorithm>

namespace sf::raycast {

namespace {

std::size_t lanes_of(const CastPlan& plan) { return std::size_t{plan.result_lanes} + std::max(plan.spare_lanes, 1u); }

}  // namespace

CastResults::CastResults(gpu::Device& device, const CastPlan& plan)
    : ranges(device, "ranges", gpu::Role::download, gpu::Texel::u32x4, gpu::texels_of<LaneRanges>(lanes_of(plan))),
      hits(device, "hits", gpu::Role::download, gpu::Texel::u32x4, gpu::texels_of<LaneHits>(lanes_of(plan))),
      beam_flags(lanes_of(plan), 0) {}

void CastResults::write(const ScannerRow& row, const double* own_ranges, const std::uint32_t* own_models,
                        const std::uint8_t* grazes) {
  const std::size_t beams = row.plan.samples.size(), lanes = row.plan.lanes(), places = SF_BEAMS_PER_LANE * lanes;
  double* const out = ranges_of(row);
  std::uint32_t* const models = models_of(row);
  std::uint32_t* const lane_flags = beam_flags.data() + row.out;
  std::fill_n(lane_flags, lanes, 0u);
  if (row.plan.packed) {
    if (own_ranges != out) std::copy_n(own_ranges, beams, out);
    if (own_models != models) std::copy_n(own_models, beams, models);
    // Unused places repeat the last beam.
    std::fill(out + beams, out + places, out[beams - 1]);
    std::fill(models + beams, models + places, models[beams - 1]);
    for (std::size_t b = 0; grazes != nullptr && b < beams; ++b)
      if (grazes[b] != 0) lane_flags[b / SF_BEAMS_PER_LANE] |= SF_GRAZING << b % SF_BEAMS_PER_LANE;
    return;
  }
  for (std::size_t b = 0; b < beams; ++b) {
    std::fill_n(out + SF_BEAMS_PER_LANE * b, SF_BEAMS_PER_LANE, own_ranges[b]);
    std::fill_n(models + SF_BEAMS_PER_LANE * b, SF_BEAMS_PER_LANE, own_models[b]);
    if (grazes != nullptr && grazes[b] != 0) lane_flags[b] |= SF_GRAZING;
  }
}

void CastResults::upload(gpu::Batch& batch, const ScannerRow& row) {
  const std::size_t lanes = row.plan.lanes();
  batch.upload(ranges, sizeof(LaneRanges) * row.out, sizeof(LaneRanges) * lanes);
  batch.upload(hits, sizeof(LaneHits) * row.out, sizeof(LaneHits) * lanes);
}

}  // namespace sf::raycast
