#pragma once
// The fit of lane edges on the device: from the points of every fan that is due to its reading, in one dispatch.

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "gpu/kernel.h"
#include "raycast/beams.h"
#include "sensors/laneedge_settings.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// What turns a ray into a point: read and written by whoever knows what rays met.
struct PointTables {
  gpu::Buffer& rows;        ///< EdgeRow of each due sensor
  gpu::Buffer& directions;  ///< a texel a beam: cosine, sine of its nominal bearing
  gpu::Buffer& normals;     ///< a texel a lane: normal deviates
  gpu::Buffer& points;      ///< a texel a beam: x, y [m], its grain in x
};

/// One thread. `context` without its world must outlive it.
class EdgeFit {
 public:
  /// @param grains [m] pixel sizes by the rows that tags name.
  /// @throws base::DeviceError when the device cannot hold the tables, base::InputError for more sensors than one
  /// dispatch takes.
  EdgeFit(const SensorContext& context, const std::vector<LaneEdge>& edges, const std::vector<double>& grains);

  /// @param lanes first lane of each due fan's results.
  void prepare(std::span<const DueSample> due, std::span<const std::uint32_t> lanes);
  /// What makes points of the results of a cast: `lanes` (Lane), `ranges` (a lane's four doubles [m]) and `hits` (its
  /// four tags) as raycast::Casts has them. To be called when these were replaced, and once before `record_points`.
  void bind(gpu::Buffer& lanes, gpu::Buffer& ranges, gpu::Buffer& hits);
  /// @param lane_groups group counts of the cast over `lanes`.
  void record_points(gpu::Batch& batch, const gpu::Buffer& lane_groups) const {
    batch.dispatch(maker_, lane_groups, 0);
  }
  std::uint32_t group_size() const { return maker_.group_size(); }  ///< of `record_points`, in lanes
  void record(gpu::Batch& batch) const { batch.dispatch(kernel_, groups_, 0); }
  void add_copies(gpu::Batch& batch);

  /// Of the i-th due sensor: its columns, and all of it. Both live until the next `prepare`.
  std::span<const double> values(std::size_t i) {
    return readings_.host<double>().subspan(sizeof(EdgeReading) / sizeof(double) * i, 4);
  }
  const EdgeReading& reading(std::size_t i) { return readings_.host<EdgeReading>()[i]; }

  PointTables tables() { return {rows_, directions_, normals_, points_}; }

  /// What never changes of each sensor, in order of `edges`.
  const std::vector<EdgeRow>& rows() const { return plan_.rows; }
  /// Cosine and sine of the beams of one sensor, as the device has them, SF_BEAMS_PER_LANE a lane.
  std::span<const double> directions(std::uint32_t edge);

 private:
  struct Plan {
    std::vector<EdgeRow> rows;
    std::vector<raycast::BeamPlan> beams;
    std::uint32_t lanes = 0;  ///< of results
    std::uint32_t direction_lanes = 0;
    std::uint32_t noise_lanes = 0;
    bool any_noise = false;
  };
  static Plan plan(const SensorContext& context, const std::vector<LaneEdge>& edges);
  void write_directions();
  bool write_rows(std::span<const std::uint32_t> lanes);
  void write_order(bool same_due);
  void draw_noise(const DueSample& due);

  base::ThreadPool& thread_pool_;
  std::uint64_t seed_;
  const std::vector<LaneEdge>& edges_;
  Plan plan_;
  std::vector<DueSample> due_;
  std::vector<std::uint32_t> written_;  ///< due rows, in order, that `rows_` holds
  bool fresh_ = true;                   ///< tables that never change are not on the device yet
  gpu::Kernel kernel_, maker_;
  gpu::Buffer rows_, directions_, normals_, grains_, readings_, groups_, points_, order_, mixtures_;
};

/// Names the noise of a sensor that is a mover's `sensor`-th lane edge: not that of a laser with the same number.
std::uint32_t edge_noise_id(std::uint32_t sensor);

}  // namespace sf::sensors
