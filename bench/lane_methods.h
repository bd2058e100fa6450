#pragma once
// Methods of the lane edge comparison: the farm's backend, and plain C++.

#include <memory>
#include <string>
#include <vector>

#include "base/thread_pool.h"
#include "bench/lane_scene.h"
#include "bench/lane_walk.h"
#include "gpu/device.h"
#include "sensors/laneedge.h"

namespace sf::bench {

/// Reads one scene, round by round.
class LaneReader {
 public:
  virtual ~LaneReader() = default;
  virtual std::string name() const = 0;
  /// Overwrites all results, to detect results that are not written.
  virtual void poison() = 0;
  virtual void read(std::size_t round) = 0;
  virtual sensors::EdgeReading reading(std::size_t sensor) const = 0;
};

/// A distance that no sensor can read.
inline constexpr double kPoisonDistance = -7.0;

/// Tables of a scene for plain C++.
struct LaneKnowledge {
  LaneJob job;
  SegmentGrid grid;
  std::unique_ptr<sensors::MarkingRaster> raster;
  std::vector<sensors::EdgeRow> rows;
  std::vector<base::Pose> X_MS;
  std::vector<world::Segment> faces;  ///< exact faces; empty for a raster
};
std::unique_ptr<LaneKnowledge> know(const LaneScene& scene);

/// `scene` and `device` must outlive it.
std::unique_ptr<LaneReader> make_farm_lanes(const LaneScene& scene, gpu::Device& device);
/// `scene` and `known` must outlive it.
std::unique_ptr<LaneReader> make_plain_lanes(const LaneScene& scene, const LaneKnowledge& known, bool native);

}  // namespace sf::bench
