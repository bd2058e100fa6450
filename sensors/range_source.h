#pragma once
// Readings of lasers, sonars and infrareds as beams and cones of occupancy maps.

#include <cstdint>
#include <span>
#include <vector>

#include "maps/range_evidence.h"
#include "sensors/cones/cone_array.h"
#include "sensors/sensor_type.h"

namespace sf::sensors {

/// One range sensor of a world.
struct RangeSensor {
  std::uint8_t type = 0;  ///< kLaser, kSonar or kInfrared
  std::uint32_t mover = 0, sensor = 0;
  auto operator<=>(const RangeSensor&) const = default;
};

/// Not thread-safe.
class RangeSource {
 public:
  /// @throws base::InputError for invalid settings. Precondition: the sensor exists
  RangeSource(const world::World& world, const RangeSensor& sensor);

  const RangeSensor& sensor() const { return sensor_; }
  double range_max() const { return limits_.max; }
  /// Returns the beams of a scan, or the cones of the transducers that fired since the reading before, without elements
  /// that state nothing. Valid until the next call. @param X_WM pose of the robot at the measurement
  std::span<const maps::RangeCone> cones(const base::ReadingBlock& reading, const base::Pose& X_WM);
  /// Adds a reading to maps of one geometry: a scan as one measurement, each cone as its own.
  void add_to(std::span<maps::LogOddsGrid* const> grids, std::span<const maps::RangeCone> cones,
              maps::RangeEvidence& evidence) const;

 private:
  struct Element {
    base::Pose X_MC;
    double half;  ///< [rad]
  };
  double sigma_at(double range) const;

  RangeSensor sensor_;
  base::RangeLimits limits_;
  std::vector<Element> elements_;
  std::size_t width_ = 1;    ///< numbers per element
  std::uint32_t turns_ = 1;  ///< as ConeArray::turns
  double seen_ = 1.0;        ///< as maps::RangeCone::seen
  double constant_ = 0.0, proportional_ = 0.0;
  std::uint64_t last_ = 0;  ///< sequence number of the last reading
  bool is_first_ = true;
  std::vector<maps::RangeCone> cones_;
};

}  // namespace sf::sensors
