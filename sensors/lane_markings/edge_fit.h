#pragma once
// Fits lane edges: on the device, in one dispatch for the points of all due sensors, or on the host, as rays are cast.

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

/// Tables for the kernels that convert ray hits to points.
struct PointTables {
  gpu::Buffer& rows;        ///< EdgeRow of each due sensor
  gpu::Buffer& directions;  ///< one texel per beam: cosine and sine of its nominal bearing
  gpu::Buffer& normals;     ///< one texel per lane: normal deviates
  gpu::Buffer& points;      ///< one texel per beam: x, y [m], with its pixel size in the last bits of x
};

/// Not thread-safe. `context` must outlive it, except for `context.world`.
class EdgeFit {
 public:
  /// @param grains [m] pixel sizes; tags hold indices into them
  /// @param on_host true: records nothing; call `fit_on_host` for each due sensor after `prepare`
  /// @throws base::DeviceError when the device cannot hold the tables, base::InputError for more sensors than one
  /// dispatch can process
  EdgeFit(const SensorContext& context, const std::vector<LaneEdge>& edges, const std::vector<double>& grains,
          bool on_host);

  /// @param lanes first result lane of each due sensor
  void prepare(std::span<const DueSample> due, std::span<const std::uint32_t> lanes);
  /// Binds the results of a raycast::RayCaster, the input of `record_points`: `lanes` (Lane), `ranges` (four doubles
  /// per lane [m]) and `hits` (four tags per lane). Call it once before `record_points`, and again after these tables
  /// were replaced.
  void bind(gpu::Buffer& lanes, gpu::Buffer& ranges, gpu::Buffer& hits);
  /// @param lane_groups group counts of the cast over `lanes`
  void record_points(gpu::Batch& batch, const gpu::Buffer& lane_groups) const {
    batch.dispatch(maker_, lane_groups, 0);
  }
  void record(gpu::Batch& batch) const { batch.dispatch(kernel_, groups_, 0); }
  void add_copies(gpu::Batch& batch);
  /// Fits the edge of the i-th due sensor. Several threads may fit different sensors. @param ranges, tags as in `bind`
  void fit_on_host(std::size_t i, std::uint32_t lane, std::span<const double> ranges,
                   std::span<const std::uint32_t> tags);

  /// Returns the columns and the full record of the i-th due sensor, valid until the next `prepare`.
  std::span<const double> values(std::size_t i) {
    return readings_.host<double>().subspan(sizeof(EdgeReading) / sizeof(double) * i, 4);
  }
  const EdgeReading& reading(std::size_t i) { return readings_.host<EdgeReading>()[i]; }

  PointTables tables() { return {rows_, directions_, normals_, points_}; }

  /// Returns the constant fields of each sensor's row, in order of `edges`.
  const std::vector<EdgeRow>& rows() const { return plan_.rows; }
  /// Returns cosine and sine of one sensor's beams as uploaded, SF_BEAMS_PER_LANE per lane.
  std::span<const double> directions(std::uint32_t edge);

 private:
  struct Plan {
    std::vector<EdgeRow> rows;
    std::vector<raycast::BeamPlan> beams;
    std::uint32_t lanes = 0;  ///< lanes of results
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
  raycast::Episodes episodes_;
  const std::vector<LaneEdge>& edges_;
  std::vector<double> sizes_;  ///< [m] pixel sizes
  bool on_host_;
  Plan plan_;
  std::vector<DueSample> due_;
  std::vector<std::uint32_t> written_;  ///< due rows, in order, in the current `rows_`
  bool fresh_ = true;                   ///< constant tables are not yet on the device
  gpu::Kernel kernel_, maker_;
  gpu::Buffer rows_, directions_, normals_, grains_, readings_, groups_, points_, order_, mixtures_;
};

/// Returns the random-number id of a mover's `sensor`-th lane edge sensor, distinct from that of a laser with the same
/// number.
std::uint32_t edge_noise_id(std::uint32_t sensor);

}  // namespace sf::sensors
