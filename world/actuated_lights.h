#pragma once
// Runs the actuated programs of a plan, whose stages are extended, called and skipped by detectors.
//
//   ActuatedLights lights(world, plan);
//   lights.detect({x, y}, time);                // a robot's received state
//   lights.step(time);                          // before each query; more frequent calls react faster
//   lights.forecasts(time)                      // of all lights of the world

#include <cstdint>
#include <vector>

#include "world/light_plan.h"
#include "world/lights.h"

namespace sf::world {

/// Times [s] are non-decreasing. World and plan must outlive it. Not thread-safe.
class ActuatedLights {
 public:
  static constexpr double kHeard = 0.5;  ///< [s] for which a received state counts as a call

  /// Starts the first stage of all actuated programs at `time` [s].
  ActuatedLights(const World& world, const LightPlan& plan, double time = 0.0);

  /// Reports a robot at `p` [m].
  void detect(glm::dvec2 p, double time);

  /// Ends stages that are due. Changes start at `time` even if the call is late, so no yellow is shorter than planned.
  void step(double time);

  /// Returns one forecast per light of the world, from its program or else from the world's plan.
  std::vector<SignalForecast> forecasts(double time) const;

 private:
  struct Run {
    const LightProgram* program = nullptr;
    std::size_t stage = 0;
    double since = 0.0;  ///< [s] start of the stage, or of the change to `next`
    bool changing = false;
    std::size_t next = 0;
    std::vector<double> called;  ///< [s] per stage: last call; -infinity: none since its last end
  };
  bool has_call(const LightDetector& detector, double last, double time) const;
  void note_calls(Run& run, double time) const;
  void step(Run& run, double time) const;
  std::size_t next_stage(const Run& run) const;
  double change_time(const Run& run) const;
  SignalForecast forecast(const Run& run, std::size_t i, double time) const;

  const World& world_;
  const LightPlan& plan_;
  std::vector<double> last_;  ///< [s] per detector: time of the last state there
  std::vector<Run> runs_;
};

}  // namespace sf::world
