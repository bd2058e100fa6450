#pragma once
// Tables that kernels read about a tick's scans, on every caster: beam directions, and the lanes of due scanners.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "raycast/cast_plan.h"
#include "raycast/sensor_context.h"

namespace sf::raycast {

/// Lanes of the due scanners whose ranges have the same precision.
struct LaneTable {
  gpu::Buffer lanes;   ///< one Lane per invocation
  gpu::Buffer groups;  ///< group counts for a dispatch over `lanes`
};

/// Not thread-safe, except for `turn_beams`. `plan` and the device must outlive this object.
class CastUploads {
 public:
  /// @throws base::DeviceError if the tables exceed the device's memory
  CastUploads(const SensorContext& context, const CastPlan& plan);

  /// Applies the angular noise of one due sample to its beams. @param thread index of the calling pool thread
  /// @return [rad] noise of each cast beam, valid until the thread's next call
  std::span<const double> turn_beams(const DueSample& due, unsigned thread);
  /// Applies angular noise to all due samples that have it.
  void turn_all_beams(std::span<const DueSample> due, base::ThreadPool& thread_pool);
  /// Lists the lanes of the due scanners.
  void write_lanes(std::span<const DueSample> due);
  /// Records copies of all tables that changed since the last call.
  void add_copies(gpu::Batch& batch, std::span<const DueSample> due);

  /// Returns the beam tables that start at `lane`.
  BeamTables beam_tables(std::uint32_t lane) {
    return {mid_bearings_.host<float>().data() + lane, directions64_.host<double>().data() + 8 * std::size_t{lane}};
  }
  gpu::Buffer& mid_bearings() { return mid_bearings_; }
  gpu::Buffer& directions64() { return directions64_; }
  LaneTable& exact() { return exact_; }                   ///< scanners with 64-bit ranges
  std::optional<LaneTable>& single() { return single_; }  ///< scanners that are `single`, if any

 private:
  void write_all_beams();
  void write_lanes(std::span<const DueSample> due, bool is_single, LaneTable& table);

  const CastPlan& plan_;
  Episodes episodes_;
  gpu::Buffer mid_bearings_, directions64_;
  LaneTable exact_;
  std::optional<LaneTable> single_;
  std::vector<std::vector<double>> angle_offsets_;  ///< scratch per thread
  std::vector<std::uint32_t> lanes_written_;        ///< due rows in the lane tables, in order
  bool any_lanes_ = false;                          ///< the lane tables have been written
  bool beams_changed_ = true;
  bool lanes_changed_ = true;
};

}  // namespace sf::raycast
