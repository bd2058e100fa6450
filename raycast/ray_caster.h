#pragma once
// Fans of beams cast at once: what the laser range finder and the lane edge sensor share.
//
// Ranges are exact: the nearest surface along each beam, from either side, decided in 64 bits against the segments of
// the world, within `exact_bound` of real arithmetic. A beam that meets nothing within range_max reads range_max. A
// surface that touches the sensor (within SF_TOUCH along the beam) stops beams that go into it, which read 0, not beams
// that leave it. A sensor inside a solid reads the way out of it. The mover that carries the sensor is never seen.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "raycast/beams.h"
#include "raycast/device_scene.h"
#include "raycast/sensor_context.h"

namespace sf::raycast {

/// Sine of the angle below which a beam grazes what it meets: rounding then moves its range by more than `exact_bound`.
inline constexpr double kMinSine = SF_MIN_SINE;

/// [m] largest error of a range in 64 bits, of a beam that does not graze, against real arithmetic on the world's own
/// doubles and the sensor's pose: with u = 2^-53, of numerator and denominator of t = (e x w) / (e x d) at most 4 u |e|
/// |w| and 9 u |e|, |w| <= range + longest, and of outlines that were moved 4 u farthest; and what counts as touching.
/// @param longest [m] surface  @param farthest [m] coordinate of anything in range
inline constexpr double exact_bound(double range_max, double longest, double farthest) {
  return SF_CONTACT_DISTANCE + 0x1p-53 * (16.0 * (range_max + longest) + 4.0 * farthest) / kMinSine;
}

/// [m] what 32 bits may add to the error of a range.
inline double single_bound(double range_max) { return range_max * (0.51 * SF_SINGLE_TOLERANCE + 0x1p-22); }

/// One fan: the beams of one sensor.
struct Scanner {
  world::Laser laser;        ///< its settings; range noise is not applied here, angular noise is
  std::uint32_t mover = 0;   ///< that carries it
  std::uint32_t sensor = 0;  ///< names its noise
  bool single = false;       ///< measured in 32 bits where these are close enough: within `single_bound`
};

/// Where one due fan's results lie in the tables of results.
struct ScanResult {
  std::uint32_t row = 0;             ///< of the fan
  std::uint32_t lane = 0;            ///< first of its lanes, of SF_BEAMS_PER_LANE results each
  std::uint32_t beams = 0;           ///< first lane of its beam tables
  const BeamPlan* plan = nullptr;    ///< which samples were cast, and their places
  const Scanner* scanner = nullptr;  ///< its settings
  Pose X_WS;                         ///< where it looked from
  glm::dvec2 heading;                ///< unit vector
};

/// Not thread-safe. `context` without its world must outlive it.
class RayCaster {
 public:
  /// @param world what there is to see, which may be an excerpt of the site's. Its movers are the site's.
  /// @throws base::DeviceError when the device cannot hold the tables.
  RayCaster(const SensorContext& context, const world::World& world, std::vector<Scanner> scanners);
  ~RayCaster();

  const std::vector<Scanner>& scanners() const;
  const BeamPlan& plan(std::uint32_t scanner) const;
  SensorStats stats() const;
  bool on_device() const;  ///< false: the host casts, and the batch has nothing to do for it

  void set_poses(std::span<const Pose> poses);
  /// Rows of `due` are fans. @param cast false: only where they look from is wanted
  /// @return true when kernels must be recorded again.
  bool prepare(std::span<const DueSample> due, std::span<const Pose> poses, bool cast = true);
  void record(gpu::Batch& batch);
  /// @param results whether ranges and hits are wanted on the host.
  void add_copies(gpu::Batch& batch, bool results);
  /// Of the i-th due fan, after `prepare`.
  ScanResult results(std::size_t i) const;
  /// Adds up what the batch did; to be called once after it ran.
  void count();

  // Tables of results, on the device and (when copied) on the host; and the beams' directions in their sensor's frame.
  gpu::Buffer& ranges();        ///< SF_BEAMS_PER_LANE doubles [m] a lane
  gpu::Buffer& hits();          ///< SF_BEAMS_PER_LANE words a lane: `Segment::model` of what was met, or SF_NO_HIT
  gpu::Buffer& beam_flags();    ///< a word a lane: SF_DOUBT, SF_GRAZES
  gpu::Buffer& directions64();  ///< SF_BEAMS_PER_LANE pairs of doubles a lane: cosine and sine of the bearing
  gpu::Buffer& lanes();   ///< Lane: which due fan and which of its lanes each invocation casts, but for `single` fans
  gpu::Buffer& groups();  ///< group counts of the dispatch over `lanes`
  std::uint32_t group_size() const;

 private:
  struct Tables;
  std::unique_ptr<Tables> t_;
};

}  // namespace sf::raycast
