#pragma once
// The scanners of a RayCaster, planned at load.

#include <cstdint>
#include <vector>

#include "raycast/beams.h"
#include "raycast/list_configs.h"
#include "world/world.h"

namespace sf::raycast {

/// The beams of one sensor.
struct Scanner {
  ScanSettings scan;
  std::uint32_t mover = 0;   ///< mover that carries it
  std::uint32_t sensor = 0;  ///< key of its noise
  bool single = false;       ///< ranges in 32 bits where these are accurate enough: within `single_bound`
};

/// One scanner, planned at load.
struct ScannerRow {
  base::Pose mount;        ///< in the mover's frame; z: world height of the beams, fixed at load (2.5-D world)
  double range_min = 0.0;  ///< [m]
  std::uint32_t mover = 0;
  std::uint32_t config = 0;
  std::uint32_t beams = 0;    ///< first lane of its beam tables
  std::uint32_t pattern = 0;  ///< number of its beams' pattern, without angular noise
  std::uint32_t out = 0;      ///< first lane of its results
  bool angle_noise = false;   ///< has angular noise: its beam tables are its own and change
  bool single = false;        ///< as Scanner::single
  BeamPlan plan;
};

/// Constant after construction. `world` need not outlive it.
struct CastPlan {
  /// @param scanners sorted by mover  @param noise false: none, whatever their settings
  CastPlan(const world::World& world, std::vector<Scanner> scanners, bool noise);

  std::vector<Scanner> scanners;
  std::vector<ScannerRow> rows;  ///< one per scanner
  ListConfigs configs;
  std::uint32_t patterns = 0;
  std::uint32_t beam_lanes = 0;    ///< of all beam tables; scanners with equal beams share theirs
  std::uint32_t result_lanes = 0;  ///< of all results
  std::uint32_t spare_lanes = 0;   ///< behind all results: device output of scans that the host computes
  bool any_angle_noise = false;

 private:
  void add_rows(const world::World& world, bool noise);
  void place_beams();
};

}  // namespace sf::raycast
