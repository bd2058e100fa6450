#pragma once
// The road raster, and the rays of lane edge sensors through it, on the device or on the host.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "raycast/ray_caster.h"
#include "sensors/lane_markings/edge_fit.h"
#include "sensors/lane_markings/marking_raster.h"
#include "sensors/laneedge.h"

namespace sf::sensors {

/// Casts the beams of a `raycast::RayCaster` through a raster, after that caster's own cast. Not thread-safe.
class RasterCaster {
 public:
  /// @param tag tag of paint  @param with_casts true: hits of `caster` count
  /// @param on_host true: binds and records nothing; call `cast_on_host` for each due scanner after `prepare`
  /// @throws base::DeviceError when the device cannot hold the tables
  RasterCaster(const SensorContext& context, const MarkingRaster& raster, raycast::RayCaster& caster, std::uint32_t tag,
               bool with_casts, bool on_host);

  /// Computes the poses of the due scanners. Call it after `caster.prepare` with the same number.
  void prepare(std::size_t due);
  /// Call it once before `record`, and again after the tables of `caster` were replaced.
  void bind(const PointTables& out);
  void record(gpu::Batch& batch);
  void add_copies(gpu::Batch& batch);

  /// Casts the beams of the i-th due scanner. Several threads may cast different scanners.
  void cast_on_host(std::size_t i);
  /// Results on the host, in the same places as the results of `caster`: ranges [m] and tags.
  std::span<const double> ranges() const { return ranges_; }
  std::span<const std::uint32_t> tags() const { return tags_; }

 private:
  RasterRow row_of(std::size_t i) const;

  base::ThreadPool& thread_pool_;
  raycast::RayCaster& caster_;
  double cell_;
  double columns_, rows_;            ///< [cells]
  double first_column_, first_row_;  ///< of the raster's first cell, in the world's cells
  std::uint32_t block_columns_, block_rows_;
  std::uint32_t tag_;
  bool with_casts_;
  std::size_t due_ = 0;
  bool fresh_ = true;  ///< the raster is not yet on the device
  gpu::Kernel kernel_;
  gpu::Buffer place_, groups_, directory_, blocks_;
  std::vector<double> ranges_;       ///< on the host
  std::vector<std::uint32_t> tags_;  ///< on the host
};

}  // namespace sf::sensors
