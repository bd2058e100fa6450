#pragma once
// Loads the inputs of a simulation of the public interface.

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "control/controllers.h"
#include "gpu/device.h"
#include "sensorfarm/simulation.h"
#include "world/free_space.h"
#include "world/world.h"

namespace sf::library {

/// A world file, or a world's text with a name for it.
struct WorldSource {
  std::string file;
  std::string text;  ///< empty: the text of `file`
};

/// Returns `file`, or the installed file with that relative path if `file` does not exist here.
std::string found(const std::string& file);

/// Where the robots of a world start: their places in the file, or free places that a seed chooses.
class Starts {
 public:
  Starts() = default;
  /// @param space of clones; nullopt: robots start as in the file
  Starts(const world::World& world, std::optional<world::FreeSpace> space);

  /// Moves the robots of a copy of the world to their starts in a world alone with that seed.
  void place(world::World& world, std::uint32_t copy, std::uint64_t seed) const;

 private:
  std::vector<base::Pose> X_WM_;  ///< of the movers of one copy, in the file
  std::vector<std::uint32_t> clones_;
  std::optional<world::FreeSpace> space_;
};

struct LoadedWorld {
  world::World world;
  Starts starts;
};

/// Loads the world, adds a default robot to a world without one, clones robots and copies the world.
/// @throws base::InputError
LoadedWorld load(const WorldSource& source, const sensorfarm::Options& options);

/// Returns the open device that `options` select, shared by all callers as long as one of them holds it.
/// @throws base::DeviceError
std::shared_ptr<gpu::Device> shared_device(const sensorfarm::Options& options);

using SettingTexts = std::vector<std::pair<std::string, std::string>>;
control::ControllerConfig controller_of(const std::string& name, const SettingTexts& settings);

}  // namespace sf::library
