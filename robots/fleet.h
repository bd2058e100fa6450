#pragma once
// Everything that moves, and where it is.
//
//   Fleet fleet(world);
//   fleet.move(commands, interval);            // simulated, or
//   fleet.apply(reports);                      // told by someone else
//   farm.tick(fleet.reports()); ... fleet.contacts();
//
// The rule of `move`: movers move one after another in order of their rows, each against the walls and against where
// all others are at that moment. The result does not depend on threads, of which there is one.

#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"
#include "base/report.h"
#include "robots/neighbours.h"
#include "robots/outline.h"
#include "robots/touch.h"
#include "world/wall_grid.h"
#include "world/world.h"

namespace sf::robots {

/// How long a report is carried on with its velocity. [ns]
inline constexpr std::int64_t kCoast = 500'000'000;

/// One thread at a time. Nothing is allocated after construction.
class Fleet {
 public:
  /// All movers at their places at load, at rest, at time 0. `world` must outlive the fleet.
  explicit Fleet(const world::World& world);

  /// Simulates `dt` [ns] > 0. A command passes the mover's command law, is reduced to what the drive can follow and to
  /// what its accelerations allow from the velocity it has, then tried in substeps no longer than `Outline::step`; a
  /// substep that would make the outline touch a wall or another mover is refused, and done only as far as the last
  /// 0.5 mm before that. From there on the mover stands at once, only turning in place while it still can (a car
  /// stands): for that it may push itself off by up to 4 mm a substep. What a mover touched already (overlapping
  /// starts, reports) stops it only where its origin would come nearer to it.
  ///
  /// `Report::touched` then says what presses where (robots/touch.h): for movers that were refused a step, for those
  /// that they were refused by, and for as long as anything touches them afterwards, also while they stand. Passing
  /// by without being stopped is no touch.
  /// @param commands one per mover; not finite means 0
  void move(std::span<const base::Twist> commands, std::int64_t dt);

  /// Takes the states of movers that live elsewhere; what they touch is looked at in `predict`. A report older than
  /// what is known of the mover is left out; one of the same time replaces it. Heights are those at load, whatever
  /// reports say: the world is 2.5-D, for contacts as for sensors.
  /// @param reports finite, rows of movers that exist
  /// @return how many were taken
  std::size_t apply(std::span<const base::Report> reports);

  /// A mover that is gone touches nobody, until it is back.
  void set_gone(std::uint32_t row, bool gone) { gone_[row] = gone ? 1 : 0; }

  /// One per mover, in order of rows: the newest state. Yaw is in [-pi, pi] after `move`, as told after `apply`.
  /// A simulated mover's velocity is what it does at the end of the tick: 0 once stopped. Valid until the fleet is
  /// gone.
  std::span<const base::Report> reports() const { return reports_; }

  /// `reports()` carried on to `time` [ns] with constant twists, by kCoast at most; never backwards. What touches
  /// movers that were told by reports, there, is added to what the reports themselves say. Valid until the next call.
  std::span<const base::Report> predict(std::int64_t time);

  /// One per mover: 1 where the last `move` refused it a step, or where something touches it (`Report::touched`).
  std::span<const std::uint8_t> contacts() const { return contacts_; }

 private:
  struct Reach {
    double own;     ///< [m] farthest any point of the mover travels this tick
    double others;  ///< [m] farthest any mover's origin travels this tick
  };
  struct Touch {
    std::uint32_t sectors = 0;
    base::Vec2 away;  ///< world frame: the sum of unit vectors from what touches to the mover's origin
  };
  void move_one(std::uint32_t row, const base::Twist& velocity, double dt);
  void move_in_steps(std::uint32_t row, base::Twist velocity, double dt, std::int64_t steps);
  bool clear(std::uint32_t row, std::span<const base::Report> reports) const;
  bool refused(std::uint32_t row, const base::Pose& X_WM);
  bool leaves(std::uint32_t row, const base::Pose& X_WM, const world::Segment& wall);
  bool leaves(std::uint32_t row, const base::Pose& X_WM, const Placed& other);
  bool step(std::uint32_t row, const base::Twist& velocity, double dt);
  double press(std::uint32_t row, const base::Twist& velocity, double dt);
  bool turn_against(std::uint32_t row, const base::Twist& velocity, double dt);
  bool push_off(std::uint32_t row, const base::Twist& velocity, double dt);
  Touch touch_of(std::uint32_t row, std::span<const base::Report> reports);
  void feel();
  void feel_told();

  const world::World& world_;
  std::vector<Outline> outlines_;
  world::WallGrid walls_;
  Neighbours neighbours_;
  double widest_ = 0.0;  ///< [m] largest outline radius
  Reach reach_{};
  std::vector<base::Report> reports_;
  std::vector<base::Report> predicted_;
  std::vector<base::Twist> velocities_;
  std::vector<std::uint8_t> contacts_;
  std::vector<std::uint8_t> refused_;     ///< 1: a step in the last `move`
  std::vector<std::uint8_t> struck_;      ///< 1: someone was refused a step and touches it; 0 between calls
  std::vector<std::uint8_t> told_;        ///< 1: by a report, since the last `move`
  std::vector<std::uint8_t> gone_;        ///< 1: nobody meets it
  std::vector<Edge> next_, now_, other_;  ///< memory of `place`
};

}  // namespace sf::robots
