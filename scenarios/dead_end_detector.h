#pragma once
// Detects dead ends, in which a robot turns back and forth without leaving.

#include <cstdint>
#include <vector>

#include "base/report.h"

namespace sf::scenarios {

/// Number of reversals of turns in place (by the robot or by a supervisor), within a body's length, that make a dead
/// end. It lasts from the first of these reversals until the robot is farther than that length from the place of
/// detection.
inline constexpr std::size_t kReversals = 6;

/// Tracks one robot. Call `update` once per tick.
class DeadEndDetector {
 public:
  /// @param length [m] of the body @param interval [s] between ticks
  DeadEndDetector(double length, double interval) : length_(length), interval_(interval) {}

  void update(const base::Report& report, bool contact);
  /// Records a turn by the supervisor, to the left for positive `angle` [rad].
  void turned_by_hand(const base::Report& report, double angle);

  std::uint32_t count() const { return count_; }
  /// [s] Time in dead ends or at rest in contact.
  double stuck() const { return stuck_; }
  /// [s] The part of it at rest in contact.
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
  double side_ = 0.0;                              ///< sign of the last turn in place; 0: none yet
  bool inside_ = false;
  glm::dvec2 where_;
  std::uint32_t count_ = 0;
  std::vector<Reversal> reversals_;
  double waited_ = 0.0;  ///< [s] at rest in contact since the first of `reversals_`, to be counted only once
};

}  // namespace sf::scenarios
