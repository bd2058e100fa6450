#pragma once
// The inputs of a simulation of the public interface.

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
  std::string text;  ///< empty: that of `file`
};

/// `file`, or the installed file of that relative path where it does not exist here.
std::string found(const std::string& file);

/// Loads, lends a robot to a world without one, and clones. @throws base::InputError
world::World load(const WorldSource& source, const sensorfarm::Options& options);

/// The open device that `options` choose, shared by all that ask for it while one of them lives.
/// @throws base::DeviceError
std::shared_ptr<gpu::Device> shared_device(const sensorfarm::Options& options);

using SettingTexts = std::vector<std::pair<std::string, std::string>>;
control::ControllerConfig controller_of(const std::string& name, const SettingTexts& settings);

}  // namespace sf::library
