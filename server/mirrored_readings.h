#pragma once
// Decodes readings of any robots, as mirrored by a farm (`serve --mirror`), and draws what their sensors measured, and
// their occupancy maps, as lines.
//
//   MirroredReadings readings(world, sensor_set);
//   readings.accept(datagram, now);
//   readings.add_maps(now, lines);
//   readings.add_lines(mover, X_WM, now, lines);

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "maps/grid.h"
#include "netio/receiver.h"
#include "sensors/sensor_set.h"
#include "server/sensor_streams.h"
#include "world/world.h"

namespace sf::server {

/// A line on a horizontal plane.
struct SightLine {
  enum class Kind : std::uint8_t {
    beam,       ///< from the sensor to where the beam ended
    echoes,     ///< through the ends of neighbouring beams that hit the same surface
    lane_edge,  ///< a piece of the edge, 0.3 m long, perpendicular to the direction of measurement
    occupied,   ///< a border of occupied cells of a map
    explored    ///< a border of explored cells of a map
  } kind = Kind::beam;
  std::vector<glm::dvec2> points;  ///< [m] in the world
  double z = 0.0;                  ///< [m]
};

/// Times [ns] are on one monotonic clock. The world and the sensor set must outlive it. Not thread-safe.
class MirroredReadings {
 public:
  static constexpr std::int64_t kFresh = 1'000'000'000;  ///< [ns] maximum age of drawn readings
  static constexpr std::uint32_t kMostBeams = 45;        ///< beams drawn per scan; all are used for echoes
  static constexpr std::size_t kMostBorders = 4096;      ///< lines drawn per map and kind (maps::borders_of)

  MirroredReadings(const world::World& world, const sensors::SensorSet& sensor_set);
  MirroredReadings(const MirroredReadings&) = delete;
  MirroredReadings& operator=(const MirroredReadings&) = delete;

  /// Accepts any bytes.
  void accept(std::span<const std::uint8_t> bytes, std::int64_t now);
  /// Appends lines for the last readings of the mover's lasers and lane edge sensors, drawn from its current pose
  /// `X_WM`.
  void add_lines(std::uint32_t mover, const base::Pose& X_WM, std::int64_t now, std::vector<SightLine>& lines) const;
  /// Appends the borders of each robot's newest map, on the floor at z = 0. A map is drawn for `kFresh` and three
  /// periods of its sensor, wherever its robot is.
  void add_maps(std::int64_t now, std::vector<SightLine>& lines);
  netio::ReceiverCounts counts() const { return receiver_.counts(); }
  std::uint64_t unknown() const { return unknown_; }  ///< datagrams of unknown sensors

 private:
  using Key = std::tuple<std::uint8_t, std::uint16_t, std::uint16_t>;  ///< type, robot id, sensor
  void add_scan(const sensors::SensorSpec& laser, const base::Pose& X_WS, std::span<const double> ranges,
                std::vector<SightLine>& lines) const;
  void add_edge(std::size_t stream, const base::Pose& X_WS, double distance, std::vector<SightLine>& lines) const;

  /// A map and its lines, which are kept until the next map.
  struct Map {
    std::size_t stream = 0;
    maps::GridGeometry grid;
    std::optional<std::uint32_t> sequence;  ///< of the map that is drawn
    std::int64_t arrival = 0;               ///< [ns] of that map
    std::vector<SightLine> lines;
  };
  static void draw(Map& map, std::span<const double> words);

  std::vector<SensorStream> sources_;
  std::map<Key, std::size_t> streams_;                ///< rows of `sources_`
  std::map<std::size_t, glm::dvec2> perpendiculars_;  ///< of lane edge sensors, by stream, in their own frames
  std::vector<Map> maps_;
  std::map<std::uint32_t, std::vector<std::size_t>> by_mover_;
  netio::Receiver receiver_;
  std::uint64_t unknown_ = 0;
};

}  // namespace sf::server
