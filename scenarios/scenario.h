#pragma once
// A scenario: a world, who drives in it, and what must come of it. A TOML file of a few lines; keys in
// docs/scenarios.md.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/pose.h"
#include "control/controllers.h"
#include "netio/link_model.h"
#include "scenarios/plant.h"
#include "scenarios/simulation.h"
#include "world/world.h"

namespace sf::scenarios {

/// What one robot is told apart from all others.
struct RobotSetup {
  std::string name;                ///< of its mover
  std::optional<Actor> actor;      ///< else the scenario's
  std::optional<base::Pose> pose;  ///< [m], [rad] where it starts; else where the world has it
  int line = 0;                    ///< in the file
  int driver_line = 0;             ///< of its controller, or of the robot
};

/// One thing that must come of it.
struct Expectation {
  enum class Kind : std::uint8_t {
    no_collision,     ///< nothing stops anyone, ever
    contacts,         ///< contacts that begin, at most
    mean_error,       ///< |mean control error|, at most
    mean_abs_error,   ///< mean |control error|, at most
    map_coverage,     ///< part of what could be seen that was, at least
    lights_obeyed,    ///< nobody passes a stop line while it shows red
    done,             ///< all controllers have done what they were made for
    distance,         ///< driven by each robot, at least [m]
    checkpoints,      ///< that each robot which heads for some has passed, at least
    all_checkpoints,  ///< that all robots together have passed, at least
    tick_p99          ///< 99 of 100 ticks take at most so long [ms]: says something of the machine, too
  };
  Kind kind = Kind::no_collision;
  std::string robot;   ///< empty: the worst of all
  double limit = 0.0;  ///< in the unit of what is measured
  int line = 0;
};
std::string_view name_of(Expectation::Kind kind);  ///< its key

/// Copies of one robot of the world.
struct FleetSpawn {
  enum class Placement : std::uint8_t {
    free,  ///< wherever there is room: instead of all robots of the world
    lanes  ///< on lanes, along them: instead of those that no plan names
  };
  std::uint32_t robots = 0;  ///< how many; 0: the world's own robots
  std::string of;            ///< its name; empty: the first
  Placement place = Placement::free;
  int line = 0;  ///< of `robots` in the file
};

struct Scenario {
  std::string name;        ///< else the file's, without its ending
  std::string file;        ///< empty: made by hand
  std::string world;       ///< file, as it can be opened
  int world_line = 0;      ///< where the file names it
  double duration = 60.0;  ///< [s] simulated, at most: where `done` is expected it ends with it
  std::uint64_t seed = 1;
  double tick = 0.0;           ///< [s]; 0: the world's own
  FleetSpawn fleet;            ///< in place of the world's own robots
  std::optional<Plant> plant;  ///< of every robot; else as the world says
  double start_at = 0.0;       ///< [s]
  Actor actor;                 ///< of every robot
  int default_line = 0;        ///< of its controller; 0: the file names none
  std::vector<RobotSetup> plans;
  std::vector<Expectation> expect;
};

/// The world's path is relative to the file's folder.
/// @throws base::InputError with file and line; keys that nobody reads are refused.
Scenario parse_scenario(const std::string& file, std::string_view text);
Scenario read_scenario(const std::string& file);

/// The world as the scenario has it. @throws base::InputError for robots that the world does not have, or no room.
world::World world_of(const Scenario& scenario);

/// Who drives, one per mover of `world_of`; links have the scenario's seed. @throws base::InputError likewise.
SimulationOptions simulation_of(const Scenario& scenario, const world::World& world);

/// Row of the robot, or of the tag. @throws base::InputError with the nearest name, at file and line, where there is
/// none.
std::uint32_t row_of(const Scenario& scenario, const world::World& world, const std::string& robot, int line);

}  // namespace sf::scenarios
