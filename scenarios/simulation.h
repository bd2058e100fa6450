#pragma once
// Simulation of a fleet in closed loop: controllers, motion and sensors.
//
//   Simulation simulation(world, device, {.seed = 7, .actor = {.controller = {.name = "wander"}}});
//   while (running) recorder.write(simulation.step());
//
// One tick: motion since the last one, readings, decisions. A command decided at a tick is executed until the next.
// Sensors measure at their own due times, also between ticks.

#include <chrono>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "base/thread_pool.h"
#include "base/tick_record.h"
#include "control/controllers.h"
#include "farm/farm.h"
#include "farm/stored_reading.h"
#include "netio/link_model.h"
#include "record/run_info.h"
#include "robots/fleet.h"
#include "robots/neighbour_grid.h"
#include "scenarios/fleet_share.h"
#include "scenarios/mailbox.h"
#include "scenarios/state_link.h"
#include "world/lights.h"
#include "world/roads/network.h"
#include "world/world.h"

namespace sf::scenarios {

/// Controller of one robot, and the link by which its readings arrive.
struct Actor {
  control::ControllerConfig controller{.name = "wander"};  ///< empty name: the robot stands
  netio::LinkModel link;  ///< of the readings; V2V states and the robot's own state are not delayed
};

/// A robot that joins a run.
struct JoiningRobot {
  std::string name;  ///< see world::check_name
  std::string like;  ///< name of a robot of the world, or of its type, that it is a copy of
  base::Pose X_WM;   ///< finite; its height is that of the original
  Actor actor{.controller = {.name = ""}, .link = {}};  ///< none by default: it stands until it is commanded
};

struct SimulationOptions {
  std::uint64_t seed = 1;     ///< of noise and of the controllers' random choices
  unsigned threads = 0;       ///< of the host's part; 0: all. Does not affect results
  Actor actor;                ///< default of all robots
  std::vector<Actor> actors;  ///< per mover by row, tags included; empty: `actor` for all robots, and tags stand
  double start_at = 0.0;      ///< [s] time of the start signal
  std::optional<StateLinkOptions> states;  ///< of the robots' states to the farm; none: the farm knows the true ones
  bool no_return_inf = false;              ///< see farm::FarmOptions
  bool noise = true;                       ///< likewise
  const raycast::CasterType* caster = nullptr;  ///< null: as `raycast::choose_caster` decides
  cluster::Ranks* ranks = nullptr;  ///< that share the fleet, with the same options; null: this process has all of it
  double balance = 0.0;  ///< [s] simulated between new cuts of the tiles, by measured times; 0: tiles stay, and ranks
                         ///< keep only the walls of their own
  bool tiles = false;  ///< each rank knows and senses a part of the world (scenarios/fleet_tiles.h), which needs ranks
};

/// `world` and `device` must outlive it. One thread at a time. Ticks allocate nothing after warm-up.
class Simulation {
 public:
  /// @throws base::InputError for an unknown controller, invalid settings, or a missing requirement of a controller.
  Simulation(const world::World& world, gpu::Device& device, SimulationOptions options);

  /// Performs one tick of `world.interval`; the first one measures at time 0 without motion. Returns the readings
  /// delivered since the last tick, in order of delivery. Spans live until the next call.
  /// @throws base::InputError where a controller fails; the first robot's error
  base::TickRecord step();

  /// Completes the last step's exchange with other ranks, which otherwise runs until the next step.
  /// @throws cluster::Failure on all ranks if a controller failed on one
  void settle();
  /// How this process shares the fleet with others, and what only their exchange knows.
  FleetShare& share() { return *share_; }
  const FleetShare& share() const { return *share_; }
  /// A step that takes long throws base::Interrupted soon after `stop` returns true (base::ThreadPool). No other step
  /// may follow. Not with ranks, which would wait for each other.
  void interrupt_on(std::function<bool()> stop, std::chrono::nanoseconds patience = base::kStopLimit / 2) {
    farm_.thread_pool().interrupt_on(std::move(stop), patience);
  }

  /// Sets the commands of movers without a controller, to be executed from the next step on until they are set again.
  /// @param commands one per mover, finite; those of other movers are ignored
  void command(std::span<const base::Twist> commands);

  /// From the next step on the mover executes this command until it is given another, and its controller, if it has
  /// one, decides no more. @param command finite
  void drive(std::uint32_t mover, const base::Twist& command);

  /// Places the mover at a pose, at rest. Called between two steps.
  void put(std::uint32_t mover, const base::Pose& X_WM);

  /// Takes a mover out of the world, or puts it back where it was, at rest. An absent mover has no readings, decides
  /// nothing and stands. Called between two steps: sensors see the change from the next step on.
  void set_absent(std::uint32_t mover, bool gone);

  /// Adds a robot to the world and the run, between two steps: its sensors are read from the next step on. It
  /// changes the readings of others by its body alone. A robot that was removed returns under its name, if it is of the
  /// same kind: in its row, with its id, its random numbers and its counts going on. Time in proportion to the fleet
  /// and the world. With ranks, all call this alike. @param world the one given to the constructor; rows that it has
  /// keep their places
  /// @return its row, the last one for a new robot
  /// @throws base::InputError, with nothing changed: for a name that is taken or invalid, no such original, a pose that
  /// is not finite, invalid settings of its controller, more than world::kMostMovers, and with tiles
  std::uint32_t add_robot(world::World& world, const JoiningRobot& robot);
  /// Takes a robot out of the run between two steps. Its row, its id and its name stay its own. With ranks, all call
  /// this alike. @throws base::InputError for a row without a present robot, and with tiles
  void remove_robot(std::uint32_t mover);
  /// Robots that joined, in the order of their rows.
  const std::vector<record::JoinedMover>& joined() const { return joined_; }
  bool is_absent(std::uint32_t mover) const { return absent_[mover]; }
  /// The memory of the readings that were returned before the last `add_robot`; null after the next step.
  std::shared_ptr<const void> earlier_readings() const { return earlier_readings_; }

  const farm::Farm& farm() const { return farm_; }
  double move_seconds() const { return move_s_; }  ///< [s] wall time of controllers and motion

  /// The mover's controller; null for movers that stand, and for those of other ranks.
  const control::Controller* controller(std::uint32_t mover) const { return controls_[mover].controller.get(); }
  /// The last tick called the mover's controller.
  bool stepped(std::uint32_t mover) const { return controls_[mover].stepped; }
  /// The status of the mover's controller, on whichever rank it runs, after `settle`.
  ControlStatus status(std::uint32_t mover) const;
  const base::Intent& intent(std::uint32_t mover) const { return next_intents_[mover]; }
  /// All controllers that decide are done, of all ranks after `settle`; false without any, and before the first tick.
  bool all_done() const;
  const world::RoadNetwork* roads() const { return roads_ ? &*roads_ : nullptr; }
  /// Warnings of the first files that a controller has read (a mission).
  const std::vector<world::Warning>& warnings() const { return warnings_; }

 private:
  void warn_of_long_ways();
  struct RobotControl {
    std::unique_ptr<control::Controller> controller;  ///< null: the mover stands
    double rate = 10.0;                               ///< [Hz]
    bool on_scans = false;                            ///< steps on new scans and on contact instead of at its rate
    bool stepped = false;
    bool driven = false;             ///< from outside (`drive`)
    std::uint64_t begun = 0;         ///< number of steps at its rate
    std::optional<Mailbox> mailbox;  ///< none: readings arrive immediately
  };
  RobotControl make_control(std::uint32_t mover, const Actor& actor);
  void use_control(RobotControl control);
  void make_room();
  void check_joining(const world::World& world, const JoiningRobot& robot) const;
  std::uint32_t bring_back(std::uint32_t mover, const JoiningRobot& robot);
  void move();
  std::span<const base::ReadingBlock> sense(std::int64_t time);
  void sort_by_mover(std::span<const base::ReadingBlock> readings);
  bool index_by_mover(std::span<const base::ReadingBlock> readings);
  std::span<const base::Report> recorded_reports();
  void decide(std::int64_t time);
  void decide_one(std::uint32_t mover, std::int64_t time, unsigned thread);
  void try_to_decide(std::uint32_t mover, std::int64_t time, unsigned thread);
  std::int64_t leaves_at(const base::ReadingBlock& reading) const;
  bool due(RobotControl& robot, std::span<const base::ReadingBlock> fresh, std::int64_t time, bool contact) const;
  void begin();
  ControlStatus own_status(std::uint32_t mover) const;
  void find_others(std::uint32_t mover, double v2v_range, std::vector<control::Neighbour>& others) const;

  std::unique_ptr<FleetShare> share_;
  const world::World& whole_;  ///< as loaded
  const world::World& world_;  ///< the part of it that this process needs
  std::optional<world::RoadNetwork> roads_;
  farm::Farm farm_;
  robots::Fleet fleet_;
  std::optional<StateLink> states_;  ///< none: the farm knows the true states
  robots::NeighbourGrid neighbours_;
  std::vector<RobotControl> controls_;  ///< per mover
  std::vector<base::Twist> commands_;
  std::vector<base::Twist> executed_commands_;  ///< executed in the interval before the recorded tick
  /// Readings of this tick: as returned where already in order, else `sorted_`.
  std::span<const base::ReadingBlock> by_mover_;
  std::vector<std::uint32_t> first_;  ///< per mover: index of its first reading; the last entry is the end
  std::vector<std::uint32_t> next_;   ///< scratch
  std::vector<base::ReadingBlock> sorted_;
  std::vector<farm::StoredReading> early_;    ///< readings delivered between ticks; slots are reused with their memory
  std::vector<base::ReadingBlock> readings_;  ///< these and the tick's; empty without readings between ticks
  std::vector<base::Intent> intents_;         ///< per mover, as broadcast in this tick
  std::vector<base::Intent> next_intents_;    ///< as broadcast from the next tick on
  std::vector<std::vector<control::Neighbour>> others_;  ///< per thread
  std::vector<world::Signal> signals_;
  std::vector<base::LightStatus> light_states_;  ///< likewise, of the recorded tick
  std::vector<bool> absent_;                     ///< per mover
  std::vector<base::Report> present_;            ///< reports with kAbsent, of one tick; empty: all are present
  std::vector<world::Warning> warnings_;
  std::mutex failure_lock_;
  std::exception_ptr failure_;                    ///< of a controller in this tick
  std::uint32_t failed_ = world::kNone;           ///< its mover, the first that failed
  double v2v_range_ = 0.0;                        ///< [m] largest of all controllers
  std::shared_ptr<const void> earlier_readings_;  ///< until the next step
  std::vector<record::JoinedMover> joined_;
  std::uint64_t seed_;
  std::int64_t start_at_;
  std::int64_t interval_;  ///< [ns]
  std::uint64_t tick_ = 0;
  double move_s_ = 0.0;
};

}  // namespace sf::scenarios
