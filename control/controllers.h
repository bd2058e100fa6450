#pragma once
// Every controller there is, by name.

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

/// What a controller may know before it starts. All of it outlives it.
struct ControllerContext {
  const world::World& world;
  std::uint32_t mover = 0;                          ///< row of the robot
  std::uint64_t seed = 0;                           ///< of its own choices
  const world::RoadNetwork* roads = nullptr;        ///< null: the world has none
  std::vector<world::Warning>* warnings = nullptr;  ///< gets what there is to warn of in files that it reads
};

/// One kind of controller. Defined as `constinit const ControllerType x_controller` beside its class, listed in
/// control/controllers.cpp.
struct ControllerType {
  std::string_view name;        ///< "lane-keeping"
  std::string_view summary;     ///< one line for help
  double rate = 10.0;           ///< [Hz] unless the user says otherwise
  bool stops_on_bumper = true;  ///< its shell stops it while the bumper is pressed, unless the user says otherwise
  /// @throws base::InputError for settings it cannot have, or a world or robot that lacks what it needs.
  std::unique_ptr<Controller> (*make)(const ControllerContext& context, Settings& settings);
};

std::span<const ControllerType* const> controllers();
/// @return null when there is none of that name.
const ControllerType* find_controller(std::string_view name);

/// What the user asked for: a controller within the control shell.
struct ControllerConfig {
  std::string controller;
  double rate = 0.0;  ///< [Hz]; 0: its own
  Settings settings;  ///< with the shell's own: `start`, `wait_on_bumper`
};

struct ConfiguredController {
  std::unique_ptr<Controller> controller;
  double rate = 10.0;  ///< [Hz]
};

/// @throws base::InputError for a name that is no controller, with the nearest; for settings that nobody reads.
ConfiguredController make_controller(const ControllerContext& context, ControllerConfig plan);

}  // namespace sf::control
