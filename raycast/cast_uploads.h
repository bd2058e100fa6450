#pragma once
// What kernels read of a tick's scans, wherever these are cast: directions of beams, and lanes of due scanners.

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

/// The lanes of due scanners whose ranges have one precision.
struct LaneTable {
  gpu::Buffer lanes;   ///< Lane per invocation
  gpu::Buffer groups;  ///< group counts of the dispatch over `lanes`
};

/// Not thread-safe, except for `turn_beams`. `plan` and the device must outlive it.
class CastUploads {
 public:
  /// @throws base::DeviceError when the device cannot hold the tables
  CastUploads(const SensorContext& context, const CastPlan& plan);

  /// Applies the angular noise of one due sample to its beams. @param thread index of the calling pool thread
  /// @return [rad] noise of each cast beam, until the thread's next call
  std::span<const double> turn_beams(const DueSample& due, unsigned thread);
  /// Applies the angular noise of all due samples that have any.
  void turn_all_beams(std::span<const DueSample> due, base::ThreadPool& thread_pool);
  /// Lists the lanes of the due scanners.
  void write_lanes(std::span<const DueSample> due);
  /// Adds copies of all tables that changed since the last call.
  void add_copies(gpu::Batch& batch, std::span<const DueSample> due);

  /// The beam tables that begin at `lane`.
  BeamTables beam_tables(std::uint32_t lane) {
    return {mid_bearings_.host<float>().data() + lane, directions64_.host<double>().data() + 8 * std::size_t{lane}};
  }
  gpu::Buffer& mid_bearings() { return mid_bearings_; }
  gpu::Buffer& directions64() { return directions64_; }
  LaneTable& exact() { return exact_; }                   ///< scanners with ranges in 64 bits
  std::optional<LaneTable>& single() { return single_; }  ///< scanners that are `single`, where there are any

 private:
  void write_all_beams();
  void write_lanes(std::span<const DueSample> due, bool is_single, LaneTable& table);

  const CastPlan& plan_;
  std::uint64_t seed_;
  gpu::Buffer mid_bearings_, directions64_;
  LaneTable exact_;
  std::optional<LaneTable> single_;
  std::vector<std::vector<double>> angle_offsets_;  ///< scratch per thread
  std::vector<std::uint32_t> lanes_written_;        ///< due rows, in order, in the lane tables
  bool any_lanes_ = false;                          ///< the lane tables are defined
  bool beams_changed_ = true;
  bool lanes_changed_ = true;
};

}  // namespace sf::raycast
