#pragma once
// How controllers fared: their error, whether they are done, the checkpoints they passed.

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

/// For people.
std::string text_of(const control::ErrorSummary& facts);
std::string text_of(const control::LocalizationError& facts);

/// Robots that stand at the end for one reason.
struct Standing {
  std::string reason;              ///< as their controllers state it
  std::vector<std::string> names;  ///< at most kNamed of them
  std::uint64_t robots = 0;
  double seconds = 0.0;  ///< [s] the longest has stood
  static constexpr std::size_t kNamed = 3;
};
/// "roomba0 for 598 s: 'roomba1' stands in its way".
std::string text_of(const Standing& standing);

/// Of a run's robots that have a controller, all together.
struct ControlReport {
  std::string controller;                   ///< its name
  std::uint64_t robots = 0;                 ///< that it drives
  std::uint64_t done = 0;                   ///< of these, at the end
  control::ErrorSummary error;              ///< of all steps of all of them
  bool has_goals = false;                   ///< one of them headed for a checkpoint
  std::uint64_t checkpoints = 0;            ///< that they no longer head for, since the next or none is due
  control::LocalizationError localization;  ///< of those that localize themselves, beside their true poses
  std::vector<Standing> standing;           ///< not done, and without motion for kStill or longer: most robots first
};

/// Robots that have not moved for so long stand. [s]
inline constexpr double kStill = 3.0;

/// Follows a simulation, which must outlive it, tick by tick.
class ControlMetrics {
 public:
  ControlMetrics(const scenarios::Simulation& simulation, std::size_t movers, std::string controller);

  /// A robot joined, in the last row.
  void add_mover();
  /// After every `Simulation::step`, with what it gave.
  void update(const base::TickRecord& tick);
  /// @param ranks that share the fleet, which all call this; null: none
  ControlReport facts(const world::World& world, cluster::Ranks* ranks = nullptr) const;

 private:
  const scenarios::Simulation& simulation_;
  ControlReport facts_;
  /// A robot since it last moved.
  struct Rest {
    base::Pose X_WM;
    std::int64_t since = 0;  ///< [ns]
    bool contact = false;    ///< at the last tick
  };
  /// Of a robot at the end.
  struct End {
    std::optional<control::LocalizationError> localization;
    std::string reason;  ///< why it stands; empty: none was stated, or it drives
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
