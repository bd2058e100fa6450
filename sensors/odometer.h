#pragma once
// How far wheels roll while a robot moves, and how that is miscounted.

#include <cstdint>

#include "base/pose.h"
#include "base/random.h"

namespace sf::sensors {

/// [m] that the left and the right wheel roll, forwards positive.
struct Rolled {
  double left = 0.0;
  double right = 0.0;
};

/// From `before` to `after` along the one arc of constant curvature whose chord that is, turning by at most half a
/// turn; of a chord that is no such arc's (a push to the side) the part along the heading half way counts.
/// @param track [m] between the wheels, as they see it
Rolled roll(const base::Pose& before, const base::Pose& after, double track);

/// What one wheel's counter adds to the way it rolled: a random walk over distance, whose variance is slip^2 times the
/// metres rolled either way. Its steps are fixed along that distance, a centimetre each, so it is one walk however the
/// way is cut into ticks.
class Slippage {
 public:
  /// @param walk names it: its `c` counts steps; @param slip [m^(1/2)] >= 0; 0: none
  Slippage(const base::RandomKey& walk, std::uint32_t wheel, double slip) : walk_(walk), wheel_(wheel), slip_(slip) {}

  /// @param distance [m] >= 0, rolled on
  void advance(double distance);
  /// [m]
  double error() const { return error_; }

 private:
  double step(std::uint64_t number) const;

  base::RandomKey walk_;
  std::uint32_t wheel_;
  double slip_;
  double rolled_ = 0.0;      ///< [steps] either way
  std::uint64_t steps_ = 0;  ///< of them, whole ones
  double whole_ = 0.0;       ///< [m] of these
  double error_ = 0.0;
};

}  // namespace sf::sensors
