#pragma once
// Results of scans, in the layout that kernels use.

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "raycast/cast_plan.h"

namespace sf::raycast {

/// The device must outlive this object.
struct CastResults {
  /// @throws base::DeviceError if the tables exceed the device's memory
  CastResults(gpu::Device& device, const CastPlan& plan);

  gpu::Buffer ranges;  ///< SF_BEAMS_PER_LANE doubles [m] per lane
  gpu::Buffer hits;    ///< SF_BEAMS_PER_LANE words per lane: `Segment::model` of the hit, or SF_NO_HIT
  std::vector<std::uint32_t> beam_flags;  ///< one word per lane: SF_UNCERTAIN, SF_GRAZING

  double* ranges_of(const ScannerRow& row) {
    return ranges.host<double>().data() + SF_BEAMS_PER_LANE * std::size_t{row.out};
  }
  std::uint32_t* models_of(const ScannerRow& row) {
    return hits.host<std::uint32_t>().data() + SF_BEAMS_PER_LANE * std::size_t{row.out};
  }
  /// Writes one scan. @param own_ranges, own_models of its beams; may be the row's own tables if its lanes are packed
  /// @param grazes null if no beam grazes a surface
  void write(const ScannerRow& row, const double* own_ranges, const std::uint32_t* own_models,
             const std::uint8_t* grazes);
  /// Copies one scan to the device.
  void upload(gpu::Batch& batch, const ScannerRow& row);
};

}  // namespace sf::raycast
