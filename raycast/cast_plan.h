#pragma once
// Layout of a RayCaster's scanners, fixed at load.

#include <cstdint>
#include <vector>

#include "raycast/beams.h"
#include "raycast/list_configs.h"
#include "world/world.h"

namespace sf::raycast {

/// The beams of one sensor.
struct Scanner {
  ScanSettings scan;
  std::uint32_t mover = 0;   ///< mover that carries the sensor
  std::uint32_t sensor = 0;  ///< key of the sensor's noise
  bool single = false;       ///< computes ranges in 32 bits where the error stays within `single_bound`
};

/// Layout of one scanner, fixed at load.
struct ScannerRow {
  base::Pose mount;        ///< in the mover's frame
  double range_min = 0.0;  ///< [m]
  std::uint32_t mover = 0;
  std::uint32_t config = 0;
  std::uint32_t beams = 0;    ///< first lane of its beam tables
  std::uint32_t pattern = 0;  ///< index of its beam pattern, if it has no angular noise
  std::uint32_t out = 0;      ///< first lane of its results
  bool angle_noise = false;   ///< has angular noise, so its beam tables are not shared and change
  bool single = false;        ///< same as Scanner::single
  BeamPlan plan;
};

/// Immutable. `world` may be destroyed after construction.
struct CastPlan {
  /// @param scanners sorted by mover  @param noise false disables noise regardless of their settings
  CastPlan(const world::World& world, std::vector<Scanner> scanners, bool noise);

  std::vector<Scanner> scanners;
  std::vector<ScannerRow> rows;  ///< one per scanner
  ListConfigs configs;
  std::uint32_t patterns = 0;
  std::uint32_t beam_lanes = 0;    ///< total of all beam tables; scanners with equal beams share a table
  std::uint32_t result_lanes = 0;  ///< total of all results
  std::uint32_t spare_lanes = 0;   ///< after all results: receive the device's output for scans that the host computes
  bool any_angle_noise = false;

 private:
  void add_rows(const world::World& world, bool noise);
  void place_beams();
};

}  // namespace sf::raycast
