#pragma once
// What a learner observes: rows of 32-bit floats, written in place after each step and reset.
//
//   sensorfarm::Simulation worlds("rooms.world", {.robots = 1, .copies = 1000});
//   sensorfarm::Observations seen = worlds.observe({.every = 4, .goal_reach = 10.0});
//   worlds.step(policy(seen.values()));

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "sensorfarm/types.h"

namespace sensorfarm {

/// The columns of an observation, in this order.
struct ObservationOptions {
  std::string sensor = "laser";  ///< type of sensors; the agents are the robots that have them, as many each
  std::uint32_t every = 1;       ///< > 0: takes elements 0, `every`, 2 `every`, ... of each reading, each over the
                                 ///< sensor's limit; 1 where there is no number
  bool speeds = true;            ///< adds forward and turning speed over the robot's largest ones
  double goal_reach = 0.0;  ///< [m] > 0: adds the distance of the agent's goal over this, and cosine and sine of its
                            ///< bearing in the robot's frame
  std::uint32_t stack = 1;  ///< in [1, 1000]: repeats these columns for the last observations, the newest first; those
                            ///< before the start of an episode equal its first
};

/// A handle of observations that belong to a simulation and are written by it. All values are in [-1, 1]. Spans are
/// valid as long as a copy of this handle exists, and change with each step and reset.
class SENSORFARM_API Observations {
 public:
  std::size_t agents() const;                   ///< robots with such a sensor, by row
  std::size_t columns() const;                  ///< of a row
  std::span<const float> values() const;        ///< agents() * columns(), agent by agent
  std::span<const std::uint32_t> rows() const;  ///< per agent: its row in the simulation
  /// [m] Per agent: x and y of its goal, in the world; writable, effective from the next step or `reset` on. NaN at
  /// first: the columns of a goal are then 1, 0, 0.
  std::span<double> goals() const;
  std::span<const double> distances() const;    ///< [m] per agent: to its goal; NaN without one
  std::span<const double> progress() const;     ///< [m] per agent: how much nearer its goal came in the last step; 0
                                                ///< after a reset and after a change of the goal
  std::span<const std::uint32_t> ages() const;  ///< per agent: steps since the start of its world
  /// Recomputes the observations after goals have changed.
  void update();

  struct State;
  explicit Observations(std::shared_ptr<State> state);

 private:
  std::shared_ptr<State> state_;
};

}  // namespace sensorfarm
