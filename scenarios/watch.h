#pragma once
// What came of a run, counted as it goes: contacts, control errors, checkpoints, lights, stops.

#include <cstdint>
#include <vector>

#include "base/contact_onset.h"
#include "base/sink.h"
#include "scenarios/simulation.h"

namespace sf::scenarios {

/// Checkpoints that one mover heads for.
struct Goals {
  std::uint32_t now = base::kNoId;  ///< base::kNoId: none
  bool any = false;                 ///< there was one
  std::uint64_t passed = 0;         ///< that it no longer heads for, since the next or none is due

  /// @param next the one that it heads for from now on; base::kNoId: none
  void look(std::uint32_t next);
};

/// Of one mover.
struct RobotCounts {
  std::uint64_t contacts = 0;  ///< that began
  Goals goals;
  std::uint64_t reds = 0;      ///< stop lines passed that showed red
  std::uint64_t stops = 0;     ///< that it came to stand after it had driven
  std::vector<double> errors;  ///< control error of every step that had one
  double travelled = 0.0;      ///< [m]
};

/// Follows one simulation, tick by tick. Simulation and world must outlive it.
class Watch {
 public:
  Watch(const world::World& world, const Simulation& simulation);

  /// After every `Simulation::step`, with what it gave.
  void look(const base::TickRecord& tick);

  /// Somebody put the mover there: it has not driven that way.
  void put(std::uint32_t mover, const base::Pose& X_WM) { before_[mover].X_WM = X_WM; }

  const RobotCounts& of(std::uint32_t mover) const { return counts_[mover]; }
  std::uint64_t contacts() const;     ///< of all
  std::uint64_t reds() const;         ///< of all
  std::uint64_t checkpoints() const;  ///< of all

 private:
  /// A stop line that a light governs.
  struct Line {
    std::uint32_t light = 0;
    base::Pose X_WL;          ///< its middle, x in driving direction
    double half_width = 0.0;  ///< [m]
  };
  struct Before {
    base::ContactOnset contact;
    bool moving = false;
    base::Pose X_WM;
    bool seen = false;
  };
  void add_lines();
  void look_at_goals(std::uint32_t mover);
  void look_at_lights(const base::TickRecord& tick, std::uint32_t mover);

  const world::World& world_;
  const Simulation& simulation_;
  std::vector<Line> lines_;
  std::vector<double> fronts_;  ///< [m] per mover, from the origin to the foremost point of what can be stopped
  std::vector<Before> before_;
  std::vector<RobotCounts> counts_;
};

/// A robot has passed a stop line once its front is so far beyond it. [m]
inline constexpr double kPassed = 0.05;
/// A robot drives from the one speed on, and stands below the other. [m/s]
inline constexpr double kDriving = 0.03;
inline constexpr double kStanding = 0.002;

}  // namespace sf::scenarios
