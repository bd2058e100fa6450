#pragma once
// What came of a run, counted as it goes: contacts, control errors, checkpoints, lights, stops.

#include <cstdint>
#include <vector>

#include "base/contact_onset.h"
#include "base/sink.h"
#include "scenarios/simulation.h"

namespace sf::scenarios {

/// Checkpoints that one mover heads for.
struct CheckpointProgress {
  std::uint32_t now = base::kNoId;  ///< base::kNoId: none
  bool any = false;                 ///< there was one
  std::uint64_t passed = 0;         ///< that it no longer heads for, since the next or none is due

  /// @param next the one that it heads for from now on; base::kNoId: none
  void update(std::uint32_t next);
};

/// Of one mover.
struct RobotMetrics {
  std::uint64_t contacts = 0;  ///< that began
  CheckpointProgress goals;
  std::uint64_t red_lights_passed = 0;  ///< stop lines passed that showed red
  std::uint64_t stops = 0;              ///< that it came to stand after it had driven
  std::vector<double> errors;           ///< control error of every step that had one
  double travelled = 0.0;               ///< [m]
};

/// Follows one simulation, tick by tick. Simulation and world must outlive it.
class RunMetrics {
 public:
  RunMetrics(const world::World& world, const Simulation& simulation);

  /// After every `Simulation::step`, with what it gave.
  void update(const base::TickRecord& tick);

  /// Somebody put the mover there: it has not driven that way.
  void put(std::uint32_t mover, const base::Pose& X_WM) { before_[mover].X_WM = X_WM; }

  const RobotMetrics& of(std::uint32_t mover) const { return counts_[mover]; }
  std::uint64_t contacts() const;           ///< of all
  std::uint64_t red_lights_passed() const;  ///< of all
  std::uint64_t checkpoints() const;        ///< of all

 private:
  /// A stop line that a light governs.
  struct Line {
    std::uint32_t light = 0;
    base::Pose X_WL;          ///< its middle, x in driving direction
    double half_width = 0.0;  ///< [m]
  };
  struct PreviousTick {
    base::ContactOnset contact;
    bool moving = false;
    base::Pose X_WM;
    bool seen = false;
  };
  void add_lines();
  void update_checkpoints(std::uint32_t mover);
  void update_red_lights(const base::TickRecord& tick, std::uint32_t mover);

  const world::World& world_;
  const Simulation& simulation_;
  std::vector<Line> lines_;
  std::vector<double> fronts_;  ///< [m] per mover, from the origin to the foremost point of what can be stopped
  std::vector<PreviousTick> before_;
  std::vector<RobotMetrics> counts_;
};

/// A robot has passed a stop line once its front is so far beyond it. [m]
inline constexpr double kPassed = 0.05;
/// A robot drives from the one speed on, and stands below the other. [m/s]
inline constexpr double kDriving = 0.03;
inline constexpr double kStanding = 0.002;

}  // namespace sf::scenarios
