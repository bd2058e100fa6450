#pragma once
// How controllers fared: their error, whether they are done, the checkpoints they passed.

#include <cstdint>
#include <string>
#include <vector>

#include "scenarios/simulation.h"
#include "scenarios/watch.h"

namespace sf::apps {

/// Means of what a controller called its error, in the controller's own unit.
struct ErrorFacts {
  std::uint64_t steps = 0;  ///< with an error
  double mean = 0.0;
  double abs_mean = 0.0;
};

/// One step's more; what is no number is no error.
void add(ErrorFacts& facts, double error);
/// For people.
std::string text_of(const ErrorFacts& facts);

/// Of a run's robots that have a controller, all together.
struct ControlFacts {
  std::string controller;         ///< its name
  std::uint64_t robots = 0;       ///< that it drives
  std::uint64_t done = 0;         ///< of these, at the end
  ErrorFacts error;               ///< of all steps of all of them
  bool has_goals = false;         ///< one of them headed for a checkpoint
  std::uint64_t checkpoints = 0;  ///< that they no longer head for, since the next or none is due
};

/// Follows a simulation, which must outlive it, tick by tick.
class ControlTally {
 public:
  ControlTally(const scenarios::Simulation& simulation, std::size_t movers, std::string controller);

  /// After every `Simulation::step`.
  void look();
  ControlFacts facts() const;

 private:
  const scenarios::Simulation& simulation_;
  ControlFacts facts_;
  std::vector<scenarios::Goals> goals_;  ///< per mover
};

}  // namespace sf::apps
