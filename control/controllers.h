#pragma once
// List of all controllers, by name.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "control/controller.h"
#include "control/settings.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::control {

/// Inputs for the construction of a controller. Everything it refers to must outlive the controller.
struct ControllerContext {
  const world::World& world;
  std::uint32_t mover = 0;                          ///< row of the robot
  std::uint64_t seed = 0;                           ///< of the controller's random choices
  const world::RoadNetwork* roads = nullptr;        ///< null: the world has no road network
  std::vector<world::Warning>* warnings = nullptr;  ///< receives warnings of the files that it reads; or null
};

/// Description of one controller. Defined as `constinit const ControllerType x_controller` beside its class, listed in
/// control/controllers.cpp.
struct ControllerType {
  std::string_view name;        ///< "lane-keeping"
  std::string_view summary;     ///< one line for help
  double rate = 10.0;           ///< [Hz] default
  bool stops_on_bumper = true;  ///< default of the shell's `wait_on_bumper`
  /// @throws base::InputError for invalid settings, or when the world or the robot lacks something required.
  std::unique_ptr<Controller> (*make)(const ControllerContext& context, Settings& settings);
};

std::span<const ControllerType* const> controllers();
/// @return null for an unknown name.
const ControllerType* find_controller(std::string_view name);

/// A controller as configured by the user, run within the control shell.
struct ControllerConfig {
  std::string name;
  double rate = 0.0;  ///< [Hz]; 0: the controller's default
  Settings settings;  ///< including the shell's: `start`, `wait_on_bumper`
};

struct ConfiguredController {
  std::unique_ptr<Controller> controller;
  double rate = 10.0;  ///< [Hz]
};

/// @throws base::InputError for an unknown name (the message lists all names) and for settings that no code has read.
ConfiguredController make_controller(const ControllerContext& context, ControllerConfig config);

}  // namespace sf::control
