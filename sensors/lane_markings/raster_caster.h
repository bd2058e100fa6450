#pragma once
// The raster of the road on the device, and the rays that lane edge sensors cast into it.

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

/// Casts the fans of a `raycast::RayCaster` into a raster, after that has cast them into the rest of the world. One
/// thread.
class RasterCaster {
 public:
  /// @param tag of paint. @param with_casts whether what `caster` met counts.
  /// @throws base::DeviceError when the device cannot hold the tables.
  RasterCaster(const SensorContext& context, const MarkingRaster& raster, raycast::RayCaster& caster, std::uint32_t tag,
               bool with_casts);

  /// Where the fans due look from, after `caster` was prepared for as many.
  void prepare(std::size_t due);
  /// To be called when the tables of `caster` were replaced, and once before `record`.
  void bind(const PointTables& out);
  void record(gpu::Batch& batch);
  void add_copies(gpu::Batch& batch);

 private:
  RasterRow row_of(std::size_t i) const;

  base::ThreadPool& thread_pool_;
  raycast::RayCaster& caster_;
  double cell_;
  double columns_, rows_;            ///< [cells]
  double first_column_, first_row_;  ///< of the world's cells
  std::uint32_t block_columns_, block_rows_;
  std::uint32_t tag_;
  bool with_casts_;
  std::size_t due_ = 0;
  bool fresh_ = true;  ///< the raster is not on the device yet
  gpu::Kernel kernel_;
  gpu::Buffer place_, groups_, directory_, blocks_;
};

}  // namespace sf::sensors
