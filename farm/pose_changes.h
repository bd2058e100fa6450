#pragma once
// Pose changes of a tick, and the regions affected.

#include <cstdint>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "world/copies.h"

namespace sf::farm {

/// Old and new positions of the movers that moved. Allocates only to grow.
class PoseChanges {
 public:
  /// `world` must outlive it.
  explicit PoseChanges(const world::World& world);

  /// Starts a tick without moved movers.
  void begin();
  /// Records the motion of `mover`. Ignores it if both poses are bitwise equal and it was not `tilted`.
  void add(std::uint32_t mover, const base::Pose& from, const base::Pose& to, bool tilted = false);

  bool any() const { return !moved_.empty(); }
  bool moved(std::uint32_t mover) const { return flags_[mover]; }
  /// Returns whether a mover that moved carries magnets. Movers of several copies of a world carry none.
  bool magnets() const { return magnets_; }
  /// Returns whether a mover that moved was or is, with any part, within `reach` [m] of `p` in the world of `mover`.
  /// Ignores movers without a body.
  bool within(std::uint32_t mover, glm::dvec2 p, double reach);

 private:
  struct Place {
    double x, y;    ///< [m]
    double radius;  ///< [m] radius of the mover
    std::uint32_t copy;
    auto order() const { return std::pair(copy, x); }
  };
  const world::World& world_;
  world::CopyIndex copies_;
  std::vector<std::uint32_t> moved_;
  std::vector<bool> flags_;  ///< per mover
  std::vector<Place> places_;
  double largest_ = 0.0;  ///< [m] largest radius of all movers
  bool magnets_ = false;
  bool sorted_ = true;  ///< `places_` is sorted by copy and x
};

}  // namespace sf::farm
