#pragma once
// Whose poses changed in a tick, and who may notice.

#include <cmath>
#include <cstdint>
#include <vector>

#include "base/pose.h"
#include "world/world.h"

namespace sf::farm {

/// Poses of movers that are gone are not numbers.
inline bool is_gone(const base::Pose& X_WM) { return std::isnan(X_WM.x); }
inline constexpr base::Pose kGone{NAN, NAN, NAN, NAN};

/// Where movers that moved were, and where they are now. Allocates only to grow.
class PoseChanges {
 public:
  /// `world` must outlive it.
  explicit PoseChanges(const world::World& world);

  /// A tick begins: nobody has moved yet.
  void begin();
  /// `mover` went from one pose to another; nothing when both are the same to the bit.
  void add(std::uint32_t mover, const base::Pose& from, const base::Pose& to);

  bool any() const { return !moved_.empty(); }
  bool moved(std::uint32_t mover) const { return flags_[mover]; }
  /// Whether anyone who moved carries magnets.
  bool magnets() const { return magnets_; }
  /// Whether some part of anyone who moved was or is within `reach` [m] of `p`. What has no outline is nowhere.
  bool within(glm::dvec2 p, double reach);

 private:
  struct Place {
    double x, y;    ///< [m]
    double radius;  ///< [m] of the mover
  };
  const world::World& world_;
  std::vector<std::uint32_t> moved_;
  std::vector<bool> flags_;  ///< per mover
  std::vector<Place> places_;
  double largest_ = 0.0;  ///< [m] radius of all movers
  bool magnets_ = false;
  bool sorted_ = true;  ///< places are in order of x
};

}  // namespace sf::farm
