#pragma once
// Plan files of traffic lights (TOML): programs of stages in place of the plans of a world, fixed or actuated by
// detectors. docs/v2x.md describes the file.
//
//   LightPlan plan = read_light_plan("town.toml", world);   // fixed programs become plans of the world's lights
//   LightActuator lights(plan);                              // world/light_actuator.h runs the others

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "world/world.h"

namespace sf::world {

/// A place where a robot's state counts as a call, or times at which there is one.
struct LightDetector {
  std::string name;
  std::optional<glm::dvec2> p;                   ///< [m] middle of the place; nullopt: none
  double radius = 0.0;                           ///< [m] > 0
  std::vector<std::pair<double, double>> calls;  ///< [s] from, to; of the lights' time
};

/// States of a program's lights for a while. Lights that are green in it, and neither green nor yellow in the next,
/// show yellow before it, then red.
struct LightStage {
  std::vector<LightState> states;        ///< one per light of the program
  double shortest = 0.0;                 ///< [s] > 0
  double longest = 0.0;                  ///< [s] >= shortest; equal: fixed
  double gap = 0.0;                      ///< [s] without a call after which an actuated stage ends
  std::vector<std::uint32_t> detectors;  ///< rows that prolong it; and call it, where it is `on_call`
  bool on_call = false;                  ///< left out without a call since its last end
  double yellow = 0.0;                   ///< [s] >= 0
  double clear = 0.0;                    ///< [s] >= 0, of red after yellow
};

/// Lights that change together.
struct LightProgram {
  std::string name;
  std::vector<std::uint32_t> lights;  ///< rows of `World::lights`
  std::vector<LightStage> stages;     ///< at least one; repeated without end
  double offset = 0.0;                ///< [s] start of the first stage; 0 for actuated programs
};

struct LightPlan {
  std::string world;  ///< path of its world file
  std::vector<LightProgram> programs;
  std::vector<LightDetector> detectors;
};

/// Some stage has no fixed length, or is left out at times.
bool is_actuated(const LightProgram& program);
/// Light `i` of the program shows yellow between two of its stages.
bool needs_yellow(const LightProgram& program, std::size_t from, std::size_t to, std::size_t i);

/// Path of the world that a plan file names, relative to the file. @throws base::InputError with file and line
std::string world_of_plan(const std::string& file, std::string_view text);

/// Parses a plan for `world`, and replaces the plans of lights that its fixed programs have.
/// @throws base::InputError with file and line
LightPlan parse_light_plan(const std::string& file, std::string_view text, World& world);

}  // namespace sf::world
