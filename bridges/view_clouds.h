#pragma once
// Echoes of all lidars and lasers as points in the world, for the live view in three dimensions:
// `sensorfarm_msgs/msg/Clouds`.

#include <cstdint>
#include <glm/ext/vector_double3.hpp>
#include <map>
#include <string_view>
#include <vector>

#include "base/bytes.h"
#include "base/tick_record.h"
#include "bridges/bridge.h"

namespace sf::bridges {

inline constexpr std::string_view kCloudsTopic = "/view_3d/clouds";
/// Of all sensors together; each may send one more. If they have more beams, each sends one in so many.
inline constexpr std::size_t kMostViewPoints = 65'536;

/// Returns the point of the world to which the 3-D view's coordinates in 32 bits are relative [m].
glm::dvec3 view_origin(const world::World& world);

/// Keeps the newest echoes of each sensor until they are sent, because viewers do not receive every tick.
class ViewClouds {
 public:
  explicit ViewClouds(const Scene& scene);
  /// Drops all echoes first if time has gone back.
  void add(const base::TickRecord& tick);
  /// Appends the tilts of a tick, and all echoes since the last call.
  void encode(const base::TickRecord& tick, base::Bytes& out);
  std::uint32_t stride() const { return stride_; }

 private:
  struct Cloud {
    std::uint32_t mover = 0, sensor = 0;
    std::uint8_t type = 0;
    bool planar = false, is_new = false;
    glm::dvec3 position{};      ///< [m] of the sensor, relative to `origin_`
    std::vector<float> points;  ///< x, y, z [m] relative to `origin_`, and intensity; -1: not reported. In an order of
                                ///< which the first ones are spread over the scan
  };
  void add(const base::ReadingBlock& reading);
  void add_points(const base::ReadingBlock& reading, Cloud& cloud) const;

  const sensors::SensorSet& sensor_set_;
  const glm::dvec3 origin_;
  std::uint32_t stride_ = 1;
  std::int64_t time_ = 0;                  ///< [ns] of the last tick
  std::map<std::uint64_t, Cloud> clouds_;  ///< by mover, type and sensor
};

}  // namespace sf::bridges
