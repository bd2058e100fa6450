#pragma once
// Where a robot turns back and forth and does not get away.

#include <cstdint>
#include <vector>

#include "base/report.h"

namespace sf::scenarios {

/// A dead end: the direction of turns in place (its own, or by a supervisor's hand) reversed `kReversals` times while
/// the robot stayed within a body's length. It lasts from the first of these reversals until the robot is farther than
/// that from where it was found.
inline constexpr std::size_t kReversals = 6;

/// Follows one robot, tick by tick.
class DeadEndDetector {
 public:
  /// @param length [m] of the body @param interval [s] of a tick
  DeadEndDetector(double length, double interval) : length_(length), interval_(interval) {}

  void update(const base::Report& report, bool contact);
  /// Somebody turned it by hand where it stood, to the left where `angle` [rad] is positive.
  void turned_by_hand(const base::Report& report, double angle);

  std::uint32_t count() const { return count_; }
  /// [s] in dead ends, or standing in contact.
  double stuck() const { return stuck_; }
  /// [s] of it standing in contact.
  double standing_in_contact() const { return stood_; }

 private:
  struct Reversal {
    glm::dvec2 p;
    double time = 0.0;  ///< [s]
  };
  void turn(glm::dvec2 p, double side);
  void reverse(glm::dvec2 p);

  double length_, interval_;
  double time_ = 0.0, stuck_ = 0.0, stood_ = 0.0;  ///< [s]
  double side_ = 0.0;                              ///< of the last turn in place; 0: none yet
  bool inside_ = false;
  glm::dvec2 where_;
  std::uint32_t count_ = 0;
  std::vector<Reversal> reversals_;
  double waited_ = 0.0;  ///< [s] standing in contact since the first of `reversals_`: not to be counted twice
};

}  // namespace sf::scenarios
