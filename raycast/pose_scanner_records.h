#ifndef RAYCAST_POSE_SCANNER_RECORDS_H
#define RAYCAST_POSE_SCANNER_RECORDS_H
// Records of scans from poses on the device, shared by host and device (raycast/pose_scanner.h).

#ifdef __cplusplus

#include <cstdint>

namespace sf::raycast {

struct PoseScanCounts {
  std::uint32_t beams;        ///< in all
  std::uint32_t copy_movers;  ///< movers per copy of the world
  std::uint32_t nodes;        ///< of the tree of walls
  std::uint32_t ticks;        ///< number of this scan
};

struct PoseScanRow {
  double x, y;  ///< [m] mount, in the mover's frame
  double z, yaw;
  double range_min, range_max;             ///< [m]
  double range_sigma, range_proportional;  ///< raycast::ScanNoise
  std::uint32_t mover, spare_0, spare_1, spare_2;
};

/// The random numbers of a scanner: base::RandomKey.
struct PoseScanDraw {
  double sigma;
  std::uint32_t seed_low, seed_high;
  std::uint32_t a, b;   ///< words of the counter: the mover's row in its world; sensor and stream
  std::uint32_t first;  ///< PoseScanCounts::ticks at the start of its episode
  std::uint32_t spare;
};

/// The edges of a mover's outline.
struct PoseScanOutline {
  double radius;               ///< [m]
  std::uint32_t first, count;  ///< edges
};

}  // namespace sf::raycast

#endif
#endif
