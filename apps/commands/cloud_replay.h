#pragma once
// Replays the recorded scans of lidars as points.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "apps/options/recording_part.h"
#include "base/rigid_transform.h"
#include "scenarios/replay.h"
#include "sensors/lidar_beams.h"
#include "sensors/sensor_set.h"
#include "viz/vtk_files.h"
#include "world/world.h"

namespace sf::apps {

/// One scan. Valid until the replay's next call.
struct Cloud {
  std::int64_t time = 0;  ///< [ns]
  std::uint32_t mover = 0;
  const sensors::SensorSpec& row;
  const sensors::LidarSettings& lidar;
  std::span<const double> values;  ///< of the reading
  base::RigidTransform X_WS;

  std::size_t beams() const { return values.size() / lidar.echo.width; }
  double range(std::size_t i) const { return values[i * lidar.echo.width]; }  ///< [m]
  bool has_intensity() const { return lidar.echo.width > 1; }
  double intensity(std::size_t i) const { return values[i * lidar.echo.width + 1]; }
  bool is_timed() const { return !lidar.beams->times.empty(); }
  bool has_echo(std::size_t i) const { return range(i) >= lidar.echo.range_min && range(i) < lidar.echo.range_max; }
  std::size_t columns() const { return beams() / lidar.beams->channels; }
  std::uint16_t ring(std::size_t i) const { return static_cast<std::uint16_t>(i / columns()); }
  glm::dvec3 point_S(std::size_t i) const { return range(i) * lidar.beams->directions[i]; }
  glm::dvec3 point_W(std::size_t i) const { return base::transform(X_WS, point_S(i)); }
};

/// True if a chosen mover has a lidar.
bool has_lidar(const RecordingPart& part, const world::World& world);

class CloudReplay {
 public:
  /// Both must outlive it. @param world of the recording, with a lidar
  CloudReplay(const RecordingPart& part, const world::World& world);

  std::size_t ticks() const { return replay_.ticks(); }
  /// Returns the scans of chosen lidars since the preceding tick; at tick 0, or if `newest`, the newest of each.
  std::vector<Cloud> at(std::size_t tick, bool newest = false);

 private:
  const RecordingPart& part_;
  sensors::SensorSet sensor_set_;
  std::span<const sensors::LidarSettings> lidars_;
  scenarios::Replay replay_;
};

/// Returns the replay for drawing; null without lidars on chosen robots, or, with a message, without recorded scans.
std::unique_ptr<CloudReplay> clouds_to_draw(const RecordingPart& part, const world::World& world);

/// Returns a dot per echo, in the world. Point arrays: `range` [m], `ring`, `robot` (row), `sensor` (of the robot's
/// lidars), `time` [s], `intensity` (0 if the lidar has none).
viz::PolyData echoes_of(std::span<const Cloud> clouds);

}  // namespace sf::apps
