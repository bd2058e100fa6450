#pragma once
// Distance rolled by a robot's wheels, and its measurement error.

#include <cstdint>

#include "base/pose.h"
#include "base/random.h"

namespace sf::sensors {

/// Distance rolled by the left and the right wheel [m], forward positive.
struct Rolled {
  double left = 0.0;
  double right = 0.0;
};

/// Returns the distances rolled between two poses along the arc of constant curvature with this chord, turning by at
/// most half a turn. If the chord does not belong to such an arc (a push to the side), its component along the mean
/// heading counts.
/// @param track [m] effective distance between the wheels
Rolled roll(const base::Pose& before, const base::Pose& after, double track);

/// Error of one wheel's counter: a random walk over distance with variance slip^2 per metre rolled in either direction.
/// Its steps are fixed, one per centimetre, so the walk does not depend on the length of ticks.
class Slippage {
 public:
  /// @param walk key of the walk; its `c` counts steps  @param slip [m^(1/2)] >= 0; 0: none
  Slippage(const base::RandomKey& walk, std::uint32_t wheel, double slip) : walk_(walk), wheel_(wheel), slip_(slip) {}

  /// Adds a distance. @param distance [m] >= 0
  void advance(double distance);
  /// Returns the error [m].
  double error() const { return error_; }

 private:
  double step(std::uint64_t number) const;

  base::RandomKey walk_;
  std::uint32_t wheel_;
  double slip_;
  double rolled_ = 0.0;      ///< [steps] in either direction
  std::uint64_t steps_ = 0;  ///< whole steps
  double whole_ = 0.0;       ///< [m] error after the whole steps
  double error_ = 0.0;
};

}  // namespace sf::sensors
