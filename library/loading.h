#pragma once
// Loads the inputs of a simulation of the public interface.

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "control/controllers.h"
#include "gpu/device.h"
#include "sensorfarm/simulation.h"
#include "world/free_space.h"
#include "world/random_starts.h"
#include "world/world.h"

namespace sf::library {

/// A world file, or a world's text with a name for it.
struct WorldSource {
  std::string file;
  std::string text;  ///< empty: the text of `file`
};

/// Returns `file`, or the installed file with that relative path if `file` does not exist here.
std::string found(const std::string& file);

/// Returns whether a robot may be placed there: numbers within 1e7 [m, rad].
bool is_placeable(const sensorfarm::Pose& pose);

/// How the movers of a world start: as in the file and as a seed chooses, or as the caller says.
class Starts {
 public:
  Starts() = default;
  /// @param space of clones; nullopt: robots start as in the file
  Starts(const world::World& world, std::optional<world::FreeSpace> space);

  /// Gives the movers of a copy of the world their starts, sizes and variations of a world alone with that seed, or
  /// the given ones. @param given valid (`check`)  @param first entry in `given` of the copy's first row
  /// @param resized out: appends the rows whose sizes changed
  void place(world::World& world, std::uint32_t copy, std::uint64_t seed, const sensorfarm::WorldStarts& given,
             std::size_t first, std::vector<std::uint32_t>& resized);

  /// @param rows number of rows that restart, of whole worlds in turn
  /// @throws base::InputError for what `place` cannot do
  void check(const world::World& world, const sensorfarm::WorldStarts& given, std::size_t rows) const;

 private:
  void check_row(const world::World& world, const sensorfarm::WorldStarts& given, std::size_t i) const;
  static void place_given(world::World& world, std::uint32_t row, const sensorfarm::WorldStarts& given, std::size_t i);

  std::vector<world::Original> originals_;  ///< the movers of one copy
  std::vector<glm::dvec3> sizes_;           ///< [m] per mover of all copies placed so far
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

/// @throws base::InputError unless `worlds` are numbers of copies, each once, and there are as many seeds
void check_restart(const world::World& world, std::span<const std::uint32_t> worlds,
                   std::span<const std::uint64_t> seeds);

/// Returns the open device that `options` select, shared by all callers as long as one of them holds it.
/// @throws base::DeviceError
std::shared_ptr<gpu::Device> shared_device(const sensorfarm::Options& options);

using SettingTexts = std::vector<std::pair<std::string, std::string>>;
control::ControllerConfig controller_of(const std::string& name, const SettingTexts& settings);

}  // namespace sf::library
