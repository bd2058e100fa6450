#pragma once
// Results of controllers: their error, whether they are done, and the checkpoints they passed.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cluster/ranks.h"
#include "control/error_summary.h"
#include "control/own_localization.h"
#include "scenarios/run_metrics.h"
#include "scenarios/simulation.h"

namespace sf::apps {

/// Returns a summary for people.
std::string error_summary_text(const control::ErrorSummary& facts);
std::string localization_error_text(const control::LocalizationError& facts);

/// Robots that are at rest at the end for the same reason.
struct Standing {
  std::string reason;              ///< as stated by their controllers
  std::vector<std::string> names;  ///< at most kNamed of them
  std::uint64_t robots = 0;
  double seconds = 0.0;  ///< [s] longest time at rest
  static constexpr std::size_t kNamed = 3;
};
/// Returns "roomba0 for 598 s: 'roomba1' blocks its way".
std::string standing_text(const Standing& standing);

/// Combined results of the robots in a run that have a controller.
struct ControlReport {
  std::string controller;                   ///< name of the controller
  std::uint64_t robots = 0;                 ///< number of robots it drives
  std::uint64_t done = 0;                   ///< number of them that are done at the end
  control::ErrorSummary error;              ///< over all steps of all robots
  bool has_goals = false;                   ///< true if any robot headed for a checkpoint
  std::uint64_t checkpoints = 0;            ///< number of checkpoints passed
  control::LocalizationError localization;  ///< of robots that localize themselves, compared with their true poses
  std::vector<Standing> standing;           ///< not done, and at rest for kStill or longer; the largest group first
};

/// [s] Robots that have not moved for this time are at rest.
inline constexpr double kStill = 3.0;

/// Updated with each tick of a simulation, which must outlive it.
class ControlMetrics {
 public:
  ControlMetrics(const scenarios::Simulation& simulation, std::size_t movers, std::string controller);

  /// Adds a robot that joined in the last row.
  void add_mover();
  /// Called after every `Simulation::step`, with its result.
  void update(const base::TickRecord& tick);
  /// Collective over ranks.
  /// @param ranks that share the fleet; null: none
  ControlReport facts(const world::World& world, cluster::Ranks* ranks = nullptr) const;

 private:
  const scenarios::Simulation& simulation_;
  ControlReport facts_;
  /// A robot's state since it last moved.
  struct Rest {
    base::Pose X_WM;
    std::int64_t since = 0;  ///< [ns]
    bool contact = false;    ///< at the last tick
  };
  /// A robot's state at the end.
  struct End {
    std::optional<control::LocalizationError> localization;
    std::string reason;  ///< why it is at rest; empty: no reason was stated, or it moves
  };
  bool stands(std::uint32_t mover) const;
  std::vector<End> ends() const;
  static void add_ends_of_others(cluster::Ranks& ranks, std::vector<End>& ends);
  std::vector<Standing> standing(const world::World& world, const std::vector<End>& ends) const;

  std::vector<scenarios::CheckpointProgress> goals_;  ///< per mover
  std::vector<Rest> rests_;                           ///< per mover
  std::int64_t time_ = 0;                             ///< [ns] of the last tick
};

}  // namespace sf::apps
