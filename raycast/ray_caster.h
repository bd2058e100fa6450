#pragma once
// Casts the beams of many scanners at once, for lasers, lane edge sensors and cones (ConeCaster). Beams lie in the
// horizontal plane of their sensor.
//
// Ranges are exact: they are those of the nearest surface along each beam, from either side, computed from the segments
// of the world. They are within the caster's `bound` of real arithmetic, except for beams that graze a surface. A beam
// without a hit before range_max reads range_max. A surface that touches the sensor (within SF_CONTACT_DISTANCE along
// the beam) stops beams that enter it, which read 0, and does not affect beams that leave it. A sensor inside a solid
// reads the distance to its boundary. The mover that carries the sensor is invisible to it.
//
// `SceneOptions::caster` selects the caster, one of raycast/casters.h.

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gpu/batch.h"
#include "gpu/buffer.h"
#include "raycast/caster.h"
#include "raycast/casters.h"
#include "raycast/range_bounds.h"
#include "raycast/sensor_context.h"

namespace sf::raycast {

/// Location of one due scanner's results in the result tables.
struct ScanResult {
  std::uint32_t row = 0;             ///< row of the scanner
  std::uint32_t lane = 0;            ///< first of its lanes, each with SF_BEAMS_PER_LANE results
  std::uint32_t beams = 0;           ///< first lane of its beam tables
  const BeamPlan* plan = nullptr;    ///< cast samples and their places; owned by the caster
  const Scanner* scanner = nullptr;  ///< settings; owned by the caster
  Pose X_WS;                         ///< pose of the sensor
  glm::dvec2 heading;                ///< unit vector of its yaw
};

/// Not thread-safe. The device, thread pool and states of `context` must outlive this object.
class RayCaster {
 public:
  /// @param world visible geometry, which may be a subset of `context.world` but must have the same movers
  /// @throws base::DeviceError if the tables exceed the device's memory; base::InputError if the world is too large for
  /// the caster
  RayCaster(const SensorContext& context, const world::World& world, std::vector<Scanner> scanners);
  ~RayCaster();

  const std::vector<Scanner>& scanners() const { return plan_.scanners; }
  const BeamPlan& plan(std::uint32_t scanner) const { return plan_.rows[scanner].plan; }
  /// Returns a scanner's first lane in the result tables.
  std::uint32_t lane(std::uint32_t scanner) const { return plan_.rows[scanner].out; }
  /// Returns the largest error [m] of the range of a beam that does not graze a surface. Parameters as for
  /// `exact_bound`.
  double bound(double range_max, double longest, double farthest, bool single) const {
    return type_.bound(range_max, longest, farthest) + (single ? single_bound(range_max) : 0.0);
  }
  SensorStats stats() const;
  /// Returns false if scans run on the host and no kernels are recorded.
  bool on_device() const { return type_.on_device; }

  /// Moves the movers to the poses of `SensorContext::states`. Call before `prepare`.
  void place_movers() { caster_->place(); }
  /// See Caster::update_outlines. Results of the last cast stay.
  bool update_outlines(const world::World& world) { return caster_->update_outlines(world); }
  /// @param due rows of scanners  @param cast false skips scans on the host; the caller does not record a cast, and
  /// reads only the beams' directions
  /// @return true if kernels must be recorded again
  bool prepare(std::span<const DueSample> due, bool cast = true);
  void record(gpu::Batch& batch) { caster_->record(batch); }
  /// @param results also copies ranges and hits to the host
  void add_copies(gpu::Batch& batch, bool results);
  /// Returns the results of the i-th due scanner. Call after `prepare`.
  ScanResult results(std::size_t i) const;
  const Pose& X_WS(std::size_t i) const { return due_.views[i].X_WS; }  ///< pose of the i-th due scanner
  /// Returns one word per lane of the results: SF_UNCERTAIN, SF_GRAZING. Valid as long as this object.
  std::span<const std::uint32_t> beam_flags() const { return results_.beam_flags; }
  /// Reads the device's beam flags and adds its uncertain beams to `stats`. Call once after each batch.
  void take_flags() { caster_->collect(due_); }

  // Result tables, on the device and, if copied, on the host, and the beams' directions in the sensor frame.
  gpu::Buffer& ranges() { return results_.ranges; }  ///< SF_BEAMS_PER_LANE doubles [m] per lane
  /// SF_BEAMS_PER_LANE words per lane: `Segment::model` of the hit, or SF_NO_HIT.
  gpu::Buffer& hits() { return results_.hits; }
  /// SF_BEAMS_PER_LANE pairs of doubles per lane: cosine and sine of the bearing.
  gpu::Buffer& directions64() { return uploads_.directions64(); }
  /// One Lane per invocation: the due scanner and its lane. Excludes `single` scanners.
  gpu::Buffer& lanes() { return uploads_.exact().lanes; }
  /// Group counts for a dispatch over `lanes`.
  gpu::Buffer& groups() { return uploads_.exact().groups; }

 private:
  void find_views(std::size_t first, std::size_t last);

  base::ThreadPool& thread_pool_;
  const std::span<const base::Report> states_;  ///< one per mover, in this tick
  const CasterType& type_;
  const CastPlan plan_;
  CastUploads uploads_;
  CastResults results_;
  std::unique_ptr<Caster> caster_;
  DueScans due_;
  std::atomic<std::uint64_t> rays_{0};
  bool fresh_ = true;  ///< `prepare` has not run yet
};

}  // namespace sf::raycast
