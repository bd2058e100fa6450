#pragma once
// The walls of the real world, as far as lasers of real robots have shown them, for robots that are simulated: a grid
// over the farm's world, in which cells with echoes are occupied until beams pass through them. docs/robots.md has the
// rule.

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "sensors/sensor_type.h"
#include "world/world.h"

namespace sf::server {

/// Not thread-safe.
class RealWalls {
 public:
  static constexpr double kCell = 0.05;                 ///< [m] side of a cell; larger if the grid needs it
  static constexpr double kMargin = 8.0;                ///< [m] of the grid around the walls of the world
  static constexpr std::size_t kMostCells = 4'000'000;  ///< of the grid
  static constexpr double kCoarsest = 0.2;              ///< [m] larger worlds have no grid

  explicit RealWalls(const world::World& world);

  /// Adds a scan of a laser of the real world at `X_WS`. @param ranges [m] without an echo infinite, or NaN
  void add(const sensors::SensorSpec& laser, const base::Pose& X_WS, std::span<const double> ranges);
  /// Returns the distance [m] along a beam to the first occupied cell before `range`; else `range`.
  double cast(const base::Pose& X_WS, double bearing, double range) const;

  bool empty() const { return cells_.empty(); }
  double cell() const { return cell_; }

 private:
  struct Cell {
    std::uint32_t scan = 0;  ///< last scan that changed it
    std::uint8_t score = 0;
  };
  static constexpr std::uint8_t kOccupied = 2, kMostScore = 6;

  /// Calls `visit` (index, distance at which the beam enters) for the cells of the grid on the beam, until it returns
  /// false.
  template <class Visit>
  void trace(const base::Pose& X_WS, double bearing, double range, Visit&& visit) const;

  double left_ = 0.0, bottom_ = 0.0, cell_ = kCell;  ///< [m]
  std::int64_t columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;  ///< row by row from the bottom; empty before the first scan
  std::uint32_t scan_ = 0;
};

}  // namespace sf::server
