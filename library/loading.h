#pragma once
// Loads the inputs of a simulation of the public interface.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "control/controllers.h"
#include "gpu/device.h"
#include "sensorfarm/simulation.h"
#include "world/world.h"

namespace sf::library {

/// A world file, or a world's text with a name for it.
struct WorldSource {
  std::string file;
  std::string text;  ///< empty: the text of `file`
};

/// Returns `file`, or the installed file with that relative path if `file` does not exist here.
std::string found(const std::string& file);

/// Loads the world, adds a default robot to a world without one, and clones robots. @throws base::InputError
world::World load(const WorldSource& source, const sensorfarm::Options& options);

/// Returns the open device that `options` select, shared by all callers as long as one of them holds it.
/// @throws base::DeviceError
std::shared_ptr<gpu::Device> shared_device(const sensorfarm::Options& options);

using SettingTexts = std::vector<std::pair<std::string, std::string>>;
control::ControllerConfig controller_of(const std::string& name, const SettingTexts& settings);

}  // namespace sf::library
