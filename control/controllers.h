#pragma once
// List of all controllers, by name.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "control/controller.h"
#include "control/settings.h"
#include "sensors/sensor_set.h"
#include "world/copies.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sensorfarm {
struct ControllerEntry;
}

namespace sf::control {

struct ControllerType;

/// Inputs for the construction of a controller. All objects that it refers to must outlive the controller.
struct ControllerContext {
  const world::World& world;
  std::uint32_t mover = 0;                          ///< row of the robot
  std::uint64_t seed = 0;                           ///< seed of the controller's random choices
  const world::RoadNetwork* roads = nullptr;        ///< null: the world has no road network
  std::vector<world::Warning>* warnings = nullptr;  ///< receives warnings about the files that the controller reads; or
                                                    ///< null
  const sensors::SensorSet* sensor_set = nullptr;   ///< sensors of the world; null: created when needed
  const ControllerType* type = nullptr;             ///< type of the controller; set by make_controller

  /// Returns the row of the robot in its copy of the world: part of the keys of its random choices.
  std::uint32_t row_in_copy() const { return world::CopyIndex(world).row_of(mover); }
  /// Returns `sensor_set`, or one created in `made`.
  const sensors::SensorSet& sensors_or(std::optional<sensors::SensorSet>& made) const {
    return sensor_set != nullptr ? *sensor_set : made.emplace(world);
  }
  /// Returns the robot's sensors of one type.
  std::vector<sensors::SensorSpec> sensors_of(std::uint8_t sensor_type) const;
};

/// Description of one controller. Defined as `constinit const ControllerType x_controller` next to its class, and
/// listed in control/controllers.cpp.
struct ControllerType {
  std::string_view name;        ///< "lane-keeping"
  std::string_view summary;     ///< one line for help
  double rate = 10.0;           ///< [Hz] default
  bool stops_on_bumper = true;  ///< default of the shell's `wait_on_bumper`
  bool on_scans = false;        ///< without a configured rate, steps on each new scan and on contact, if the robot has
                                ///< a laser
  /// @throws base::InputError for invalid settings, or if the world or the robot lacks something required
  std::unique_ptr<Controller> (*make)(const ControllerContext& context, Settings& settings);
  const sensorfarm::ControllerEntry* entry = nullptr;  ///< entry of a user's own controller (control/own_controllers.h)
};

/// Returns the built-in controllers, then those of plug-ins in the order in which they were added.
std::span<const ControllerType* const> controllers();
/// @param name may also be the file of a plug-in, which is loaded: "./libmine.so", or "./libmine.so:name" if it has
/// several controllers
/// @return null for an unknown name
/// @throws base::InputError for a file that cannot be loaded
const ControllerType* find_controller(std::string_view name);
/// Returns the names of `controllers()`, for world::LoadOptions.
std::vector<std::string_view> controller_names();
/// Adds a controller for the rest of the program. Do not call it while another thread creates or finds controllers.
/// @param type valid until the program ends
void add_controller(const ControllerType* type);

/// A controller as configured by the user, run within the control shell.
struct ControllerConfig {
  std::string name;
  double rate = 0.0;               ///< [Hz]; 0: the controller's default
  Settings settings;               ///< including the shell's: `start`, `wait_on_bumper`, `localize`
  bool known_start = true;         ///< see OwnLocalization
  bool localized_outside = false;  ///< inputs already contain estimates: the shell never replaces them
  std::string at = {};             ///< "FILE:LINE: " of the name in a world file, prefix of errors; empty: elsewhere
};

/// Returns the settings of `ctrl`, with its line in their errors.
Settings settings_of_ctrl(const world::Mover& mover);

/// Calls `make()` and puts `at` ("FILE:LINE: " or empty) in front of errors that lack it.
template <class Make>
auto with_place(const std::string& at, Make&& make) {
  try {
    return make();
  } catch (const base::InputError& error) {
    const std::string what = error.what();
    throw base::InputError(what.starts_with(at) ? what : at + what);
  }
}

/// Returns the controller that the world file gives the robot (`ctrl`), or else `fallback`. The latter also applies,
/// with its settings, if `ctrl` has the same name and no settings. Tags have none.
ControllerConfig controller_of(const world::Mover& mover, const ControllerConfig& fallback);

struct ConfiguredController {
  std::unique_ptr<Controller> controller;
  double rate = 10.0;            ///< [Hz]
  bool on_scans = false;         ///< steps on each new scan and on contact instead of at its rate
  std::optional<bool> localize;  ///< the setting of this name; nullopt: not set
};

/// @throws base::InputError for an unknown name (the message lists all names) and for settings that no code has read
ConfiguredController make_controller(const ControllerContext& context, ControllerConfig config);

}  // namespace sf::control
