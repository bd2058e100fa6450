#pragma once
// Plan files of traffic lights (TOML): programs of stages that replace a world's plans, either fixed or actuated by
// detectors. docs/v2x.md describes the file.
//
//   LightPlan plan = parse_light_plan("town.toml", text, world);  // sets the plans of lights with fixed programs
//   ActuatedLights lights(world, plan);                            // world/actuated_lights.h runs the other programs

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "world/world.h"

namespace sf::world {

/// A place where a robot's state counts as a call, or times at which there is a call.
struct LightDetector {
  std::string name;
  std::optional<glm::dvec2> p;                   ///< [m] centre of the place; nullopt: none
  double radius = 0.0;                           ///< [m] > 0
  std::vector<std::pair<double, double>> calls;  ///< [s] from, to; in the lights' time
};

/// States of a program's lights for a while. A light that is green in this stage, and neither green nor yellow in the
/// next, shows yellow before that, then red.
struct LightStage {
  std::vector<LightState> states;        ///< one per light of the program
  double shortest = 0.0;                 ///< [s] > 0
  double longest = 0.0;                  ///< [s] >= shortest; equal: fixed
  double gap = 0.0;                      ///< [s] without a call after which an actuated stage ends
  std::vector<std::uint32_t> detectors;  ///< rows of the detectors that extend it, and call it if it is `on_call`
  bool on_call = false;                  ///< skipped if it was not called since its last end
  double yellow = 0.0;                   ///< [s] >= 0
  double clear = 0.0;                    ///< [s] >= 0, red after yellow
};

/// Lights that change together.
struct LightProgram {
  std::string name;
  std::vector<std::uint32_t> lights;  ///< rows of `World::lights`
  std::vector<LightStage> stages;     ///< at least one; repeated endlessly
  double offset = 0.0;                ///< [s] start of the first stage; 0 for actuated programs
};

struct LightPlan {
  std::string world;  ///< path of the world file
  std::vector<LightProgram> programs;
  std::vector<LightDetector> detectors;
};

/// Returns whether some stage has no fixed length or may be skipped.
bool is_actuated(const LightProgram& program);
/// Returns whether light `i` of the program shows yellow between the stages `from` and `to`.
bool needs_yellow(const LightProgram& program, std::size_t from, std::size_t to, std::size_t i);

/// Returns the path of the world named in a plan file, relative to the file.
/// @throws base::InputError with file and line
std::string world_of_plan(const std::string& file, std::string_view text);

/// Parses a plan for `world`, and sets the plans of the lights in its fixed programs.
/// @throws base::InputError with file and line
LightPlan parse_light_plan(const std::string& file, std::string_view text, World& world);

}  // namespace sf::world
