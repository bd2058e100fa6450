#pragma once
// A scenario: a world, the controllers of its robots, and expectations. A short TOML file; see docs/scenarios.md for
// its keys.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/pose.h"
#include "control/controllers.h"
#include "farm/fault.h"
#include "netio/link_model.h"
#include "scenarios/plant.h"
#include "scenarios/simulation.h"
#include "world/toml.h"
#include "world/world.h"

namespace sf::scenarios {

/// Settings of one robot that differ from the scenario's.
struct RobotSetup {
  std::string name;                ///< of the mover
  std::optional<Actor> actor;      ///< controller and link; nullopt: the scenario's
  std::optional<base::Pose> pose;  ///< [m], [rad] start pose; nullopt: the world's. z NaN: on the highest
                                   ///< road there, as high above it as in the world file
  base::Tilt tilt = {};            ///< at the start
  int line = 0;                    ///< in the file
  int controller_line = 0;         ///< line of its controller, or of the robot
};

/// One expectation.
struct Expectation {
  enum class Kind : std::uint8_t {
    no_collision,     ///< no contact of any robot
    contacts,         ///< maximum number of contacts
    mean_error,       ///< maximum of |mean control error|
    mean_abs_error,   ///< maximum of mean |control error|
    map_coverage,     ///< minimum fraction of the visible cells that the robot has mapped
    lights_obeyed,    ///< no robot passes a stop line at red
    done,             ///< all controllers have finished
    distance,         ///< [m] minimum distance driven by each robot
    checkpoints,      ///< minimum number passed by each robot that has checkpoints
    all_checkpoints,  ///< minimum number passed by all robots together
    tick_p99          ///< [ms] maximum of the 99th percentile of the duration of ticks; depends on the machine
  };
  Kind kind = Kind::no_collision;
  std::string robot;   ///< empty: the worst of all robots
  double limit = 0.0;  ///< in the unit of the measured value
  int line = 0;
};
std::string_view expectation_kind_name(Expectation::Kind kind);  ///< returns its key

/// Copies of one robot that replace robots of the world.
struct FleetSpawn {
  enum class Placement : std::uint8_t {
    free,  ///< at any free place, replacing all robots
    lanes  ///< on lanes, replacing the robots without a [[robot]] entry
  };
  std::uint32_t robots = 0;  ///< number of copies; 0: the world's own robots
  std::string of;            ///< name of the robot to copy; empty: the first
  Placement place = Placement::free;
  int line = 0;  ///< of `robots` in the file
};

/// A change of an object, of the fleet or of a lane during the run.
struct ObjectEvent {
  enum class Kind : std::uint8_t { object, add, remove, lane, shape, pose };
  std::string object;   ///< name of a mover without sensors and controller, or of the robot that joins or leaves, or of
                        ///< the lane
  double at = 0.0;      ///< [s] simulated; takes effect at the first tick at or after it
  bool present = true;  ///< in the world
  int line = 0;
  Kind kind = Kind::object;
  JoiningRobot joining = {};      ///< for `add`
  std::string use = {};           ///< for `lane` (world/roads/lane_use.h)
  world::ShapeChange shape = {};  ///< for `shape`, of any mover
  base::Pose X_WM = {};           ///< for `pose`, of any mover; z NaN: see Simulation::put
  base::Tilt tilt = {};           ///< for `pose`
};

struct Scenario {
  std::string name;    ///< default: the file's name without extension
  std::string file;    ///< empty: created in memory
  std::string world;   ///< path of the world file
  int world_line = 0;  ///< line that names it
  /// [s] simulated, at least one tick. This is the maximum: with the expectation `done` the run ends when all
  /// controllers have finished.
  double duration = 60.0;
  int duration_line = 0;  ///< line that sets it
  std::uint64_t seed = 1;
  double tick = 0.0;                              ///< [s]; 0: the world's
  FleetSpawn fleet;                               ///< replaces the world's robots
  std::optional<Plant> plant;                     ///< of every robot; nullopt: as in the world file
  double start_at = 0.0;                          ///< [s] time of the start signal
  std::optional<PositioningOptions> positioning;  ///< of robots that localize themselves; nullopt: none
  std::optional<V2vLinkOptions> v2v;              ///< between robots; nullopt: V2V is current
  std::optional<StateLinkOptions> states;  ///< of the robots' states to the farm; nullopt: it has the true states
  Actor actor;                             ///< default of all robots
  int default_line = 0;                    ///< line of its controller; 0: not in the file
  std::vector<RobotSetup> robot_setups;
  std::vector<Expectation> expect;
  std::vector<ObjectEvent> events;  ///< sorted by time
  std::vector<farm::Fault> faults;  ///< of sensors, in the order of the file
};

/// The path of the world is relative to the scenario's folder.
/// @throws base::InputError with file and line, also for unknown keys
Scenario parse_scenario(const std::string& file, std::string_view text);
Scenario parse_scenario(const std::string& file, const world::TomlNode& root);
Scenario read_scenario(const std::string& file);

/// Returns the options stated by the text of a scenario's table [positioning], without its heading.
/// @throws base::InputError with `file` and line
PositioningOptions parse_positioning(const std::string& file, std::string_view text);

/// Returns the world with the scenario's changes.
/// @throws base::InputError for unknown robots or lack of space
world::World world_of(const Scenario& scenario);
world::World world_of(const Scenario& scenario, const world::LoadOptions& load);

/// Returns one actor per mover of `world_of`, with links seeded by the scenario's seed.
/// @throws base::InputError for unknown robots
SimulationOptions simulation_of(const Scenario& scenario, const world::World& world);

/// Returns the row of a robot or tag.
/// @throws base::InputError at file and line for an unknown name, with the most similar known name
std::uint32_t row_of(const Scenario& scenario, const world::World& world, const std::string& robot, int line);

}  // namespace sf::scenarios
