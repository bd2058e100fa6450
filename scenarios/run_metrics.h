#pragma once
// Metrics of a run, updated every tick: contacts, control errors, checkpoints, lights, stops.

#include <cstdint>
#include <vector>

#include "base/contact_onset.h"
#include "base/tick_record.h"
#include "scenarios/simulation.h"

namespace sf::scenarios {

/// Progress of one mover along its checkpoints.
struct CheckpointProgress {
  std::uint32_t now = base::kNoId;  ///< id of the current checkpoint; base::kNoId: none
  bool any = false;                 ///< whether there was a current checkpoint before
  std::uint64_t passed = 0;  ///< number of passed checkpoints, counted when the next one becomes due, or none is left

  /// @param next id of the new current checkpoint; base::kNoId: none
  void update(std::uint32_t next);
};

/// Metrics of one mover.
struct RobotMetrics {
  std::uint64_t contacts = 0;  ///< number of contacts, counted at their start
  CheckpointProgress goals;
  std::uint64_t red_lights_passed = 0;  ///< stop lines passed at red
  std::uint64_t stops = 0;              ///< number of halts after driving
  std::vector<double> errors;           ///< control errors of all steps that had one
  double travelled = 0.0;               ///< [m]
};

/// Metrics of one simulation. The simulation and the world must outlive it.
class RunMetrics {
 public:
  RunMetrics(const world::World& world, const Simulation& simulation);

  /// Adds the mover that was appended to the world.
  void add_mover();

  /// Call it after every `Simulation::step` with its result; with ranks, after `Simulation::settle`.
  void update(const base::TickRecord& tick);

  /// Records that a mover was placed at a pose, so that this does not count as driving.
  void put(std::uint32_t mover, const base::Pose& X_WM) { before_[mover].X_WM = X_WM; }

  const RobotMetrics& of(std::uint32_t mover) const { return counts_[mover]; }
  std::uint64_t contacts() const;           ///< of all
  std::uint64_t red_lights_passed() const;  ///< of all
  std::uint64_t checkpoints() const;        ///< of all

 private:
  /// A stop line governed by a light.
  struct Line {
    std::uint32_t light = 0;
    base::Pose X_WL;          ///< its centre, x in driving direction
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
  std::vector<double> fronts_;  ///< [m] per mover, from the origin to the foremost colliding point
  std::vector<PreviousTick> before_;
  std::vector<RobotMetrics> counts_;
};

/// [m] Distance of the front beyond a stop line at which the line counts as passed.
inline constexpr double kPassed = 0.05;
/// [m/s] A robot counts as driving from the first speed on, and as stopped below the second.
inline constexpr double kDriving = 0.03;
inline constexpr double kStanding = 0.002;

}  // namespace sf::scenarios
