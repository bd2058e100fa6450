#pragma once
// List of all controllers, by name.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "control/controller.h"
#include "control/settings.h"
#include "sensors/sensor_set.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sensorfarm {
struct ControllerEntry;
}

namespace sf::control {

struct ControllerType;

/// Inputs for the construction of a controller. Everything it refers to must outlive the controller.
struct ControllerContext {
  const world::World& world;
  std::uint32_t mover = 0;                          ///< row of the robot
  std::uint64_t seed = 0;                           ///< of the controller's random choices
  const world::RoadNetwork* roads = nullptr;        ///< null: the world has no road network
  std::vector<world::Warning>* warnings = nullptr;  ///< receives warnings of the files that it reads; or null
  const sensors::SensorSet* sensor_set = nullptr;   ///< of the world; null: made where needed
  const ControllerType* type = nullptr;             ///< of the controller; set by make_controller
};

/// Description of one controller. Defined as `constinit const ControllerType x_controller` beside its class, listed in
/// control/controllers.cpp.
struct ControllerType {
  std::string_view name;        ///< "lane-keeping"
  std::string_view summary;     ///< one line for help
  double rate = 10.0;           ///< [Hz] default
  bool stops_on_bumper = true;  ///< default of the shell's `wait_on_bumper`
  bool on_scans = false;        ///< without a configured rate, steps on each new scan and on contact, if the robot has
                                ///< a laser
  /// @throws base::InputError for invalid settings, or when the world or the robot lacks something required.
  std::unique_ptr<Controller> (*make)(const ControllerContext& context, Settings& settings);
  const sensorfarm::ControllerEntry* entry = nullptr;  ///< of a user's own controller (control/own_controllers.h)
};

/// The farm's own, then those of plug-ins in the order in which they were added.
std::span<const ControllerType* const> controllers();
/// @param name also the file of a plug-in, which is loaded: "./libmine.so", with several controllers
/// "./libmine.so:name"
/// @return null for an unknown name
/// @throws base::InputError for a file that cannot be loaded
const ControllerType* find_controller(std::string_view name);
/// Adds a controller for the rest of the program; not while controllers are made or searched on another thread.
/// @param type lives as long as the program
void add_controller(const ControllerType* type);

/// A controller as configured by the user, run within the control shell.
struct ControllerConfig {
  std::string name;
  double rate = 0.0;  ///< [Hz]; 0: the controller's default
  Settings settings;  ///< including the shell's: `start`, `wait_on_bumper`, `localize`
};

struct ConfiguredController {
  std::unique_ptr<Controller> controller;
  double rate = 10.0;     ///< [Hz]
  bool on_scans = false;  ///< steps on each new scan and on contact instead of at its rate
};

/// @throws base::InputError for an unknown name (the message lists all names) and for settings that no code has read.
ConfiguredController make_controller(const ControllerContext& context, ControllerConfig config);

}  // namespace sf::control
