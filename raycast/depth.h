#pragma once
// How deep in a solid, or how far from one, every place is: tells cheaply, and never wrongly, that walls hide
// something.
//
// All straight ways from one disc to another pass through their hull. Where a point on its axis lies deeper in a solid
// than the hull is wide there, none gets through.

#include <vector>

#include "raycast/sight.h"

namespace sf::raycast {

/// Signed distance to the nearest wall on a grid, negative inside solids, cut off at a metre. A point is measured when
/// it is first asked for, so worlds pay for the places where robots meet. Any thread.
class Depth {
 public:
  /// @param sight must outlive it. @param most_points of the grid; its spacing follows, at least 5 cm.
  explicit Depth(const Sight& sight, std::size_t most_points = 300'000);

  /// True only when walls hide every point within `radius` of `p` from every point within `origin_radius` of `origin`,
  /// of which none that is asked for lies in a solid. Often false though they do.
  bool hides(Vec2 origin, double origin_radius, Vec2 p, double radius, Sight::Nearby& scratch) const;

 private:
  bool is_on_grid(Vec2 q) const;
  /// Of the grid's nearest point: the signed distance at `q` differs by at most the distance between them.
  float at(Vec2 q, Sight::Nearby& scratch) const;
  float measure(Vec2 p, Sight::Nearby& scratch) const;

  const Sight& sight_;
  Vec2 low_;
  double spacing_ = 0.05;  ///< [m]
  double per_spacing_ = 20.0;
  int columns_ = 0, rows_ = 0;
  mutable std::vector<float> signed_;  ///< [m] not a number where nobody has asked
};

}  // namespace sf::raycast
