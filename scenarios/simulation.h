#pragma once
// Closed-loop simulation of a fleet: controllers, motion and sensors.
//
//   Simulation simulation(world, device, {.seed = 7, .actor = {.controller = {.name = "wander"}}});
//   while (running) recorder.write(simulation.step());
//
// One tick consists of the motion since the last tick, readings, and decisions. Then the controllers of models are
// called (sensorfarm/model.h): at the start of the next step, so that changes by the caller between two steps come
// first. A command decided at a tick is executed until the next. Sensors measure at their own due times, also between
// ticks.

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
#include "control/model_controllers.h"
#include "control/shared_map.h"
#include "farm/farm.h"
#include "farm/stored_reading.h"
#include "farm/v2v_inputs.h"
#include "netio/link_model.h"
#include "record/run_info.h"
#include "robots/fleet.h"
#include "robots/neighbour_grid.h"
#include "scenarios/camera_inputs.h"
#include "scenarios/fleet_share.h"
#include "scenarios/mailbox.h"
#include "scenarios/positioning.h"
#include "scenarios/state_link.h"
#include "scenarios/v2v_link.h"
#include "world/lights.h"
#include "world/roads/lane_control.h"
#include "world/shapes.h"
#include "world/world.h"

namespace sf::scenarios {

/// The controller of one robot, and the link by which its readings arrive.
struct Actor {
  control::ControllerConfig controller{.name = "wander"};  ///< empty name: the robot remains at rest
  netio::LinkModel link;                                   ///< of the readings; the robot's own state is not delayed
};

/// A robot that joins a run.
struct JoiningRobot {
  std::string name;                                     ///< see world::check_name
  std::string like;                                     ///< name of a robot of the world, or of its type, to copy
  base::Pose X_WM;                                      ///< finite; the height is that of the original
  Actor actor{.controller = {.name = ""}, .link = {}};  ///< none by default: it remains at rest until it is commanded
};

struct SimulationOptions {
  std::uint64_t seed = 1;     ///< of noise and of the controllers' random choices
  unsigned threads = 0;       ///< on the host; 0: all. Does not affect results
  Actor actor;                ///< default of all robots
  std::vector<Actor> actors;  ///< per mover of a copy of the world by row, tags included; empty: `actor` for all
                              ///< robots, and tags at rest
  /// Tilts at the start, by row. Other movers start level.
  std::vector<std::pair<std::uint32_t, base::Tilt>> tilts = {};
  double start_at = 0.0;                   ///< [s] time of the start signal
  std::optional<StateLinkOptions> states;  ///< of the robots' states to the farm; nullopt: the farm has the true states
  std::optional<PositioningOptions> positioning;  ///< of robots that localize themselves; nullopt: none
  std::optional<V2vLinkOptions> v2v;              ///< between robots; nullopt: V2V is current. Not with tiles
  bool no_return_inf = false;                     ///< see farm::FarmOptions
  bool noise = true;                              ///< see farm::FarmOptions
  const raycast::CasterType* caster = nullptr;    ///< null: chosen by `raycast::choose_caster`
  cluster::Ranks* ranks = nullptr;  ///< share the fleet, with the same options; null: this process has all of it
  double balance = 0.0;  ///< [s] simulated time between repartitions of the tiles by measured times; 0: fixed tiles,
                         ///< and ranks keep only the walls of their own
  std::vector<farm::Fault> faults = {};  ///< see farm::FarmOptions; not with ranks
  bool tiles = false;  ///< each rank stores and senses a part of the world (scenarios/fleet_tiles.h); requires ranks
};

/// `world` and `device` must outlive it. One thread at a time. Ticks allocate nothing after warm-up.
class Simulation {
 public:
  /// @throws base::InputError for an unknown controller, invalid settings, a missing requirement of a controller, for
  /// faults and controllers of models with ranks, and for what copies of a world cannot have (world/copies.h): ranks,
  /// faults, controllers of models, and robots with delayed states, cameras or V2V, delayed readings included
  Simulation(const world::World& world, gpu::Device& device, SimulationOptions options);

  /// Performs one tick of `world.interval`; the first tick measures at time 0 without motion. Returns the readings
  /// delivered since the last tick, in order of delivery. Spans are valid until the next call.
  /// @throws base::InputError if a controller fails, with the first model's or robot's error
  base::TickRecord step();

  /// Completes the last step's exchange with other ranks, which otherwise continues until the next step.
  /// @throws cluster::Failure on all ranks if a controller failed on one
  void settle();
  /// Restarts copies of the world (farm::Farm::restart), each with its seed, between two steps: movers at rest at
  /// their `Mover::X_WM`, which the caller may have changed, with new controllers. Returns this first tick of theirs,
  /// with the readings of these copies only. Nothing happens in the others. Spans are valid until the next call.
  /// @param resized movers whose outlines the caller has changed (world::set_size)
  /// @throws base::InputError as the constructor, and if a sensor cannot restart
  base::TickRecord restart(std::span<const farm::Farm::Restart> restarts, std::span<const std::uint32_t> resized = {});
  /// Returns how this process shares the fleet with others, and the results of their exchange.
  FleetShare& share() { return *share_; }
  const FleetShare& share() const { return *share_; }
  /// Makes a long step throw base::Interrupted soon after `stop` returns true (base::ThreadPool). No further step is
  /// allowed. Not allowed with ranks, which would wait for each other.
  void interrupt_on(std::function<bool()> stop, std::chrono::nanoseconds patience = base::kStopLimit / 2) {
    farm_.thread_pool().interrupt_on(std::move(stop), patience);
  }

  /// Sets the commands of movers without a controller, executed from the next step on until they are set again.
  /// @param commands one per mover, finite; those of other movers are ignored
  void command(std::span<const base::Twist> commands);

  /// Makes the mover execute this command from the next step on, until the next command. Disables its controller, if it
  /// has one.
  /// @param command finite
  void drive(std::uint32_t mover, const base::Twist& command);

  /// Places the mover at a pose, at rest. Call it between two steps.
  /// @param X_WM z NaN: on the highest road there, as high above it as in the world file
  void put(std::uint32_t mover, const base::Pose& X_WM, const base::Tilt& tilt = {});
  /// Returns the tilt of a mover after the last tick, or where `put` placed it.
  const base::Tilt& tilt(std::uint32_t mover) const { return fleet_.reports()[mover].tilt; }

  /// Removes a mover from the world, or restores it at its last pose, at rest. An absent mover has no readings, decides
  /// nothing and remains at rest. Call it between two steps: sensors see the change from the next step on.
  void set_absent(std::uint32_t mover, bool gone);

  /// Changes the shape, colour or size of a mover, between two steps (world/shapes.h). Sensors and contacts see it from
  /// the next step on, which updates the tables of all sensors once for all changes before it (Farm::update_outlines).
  /// Readings that do not see the mover keep their bytes. Controllers keep the footprint of their start. With ranks,
  /// all make the same call.
  /// @param world the one given to the constructor
  /// @throws base::InputError, with nothing changed, as world::check_change, for more than kMostShapeChanges before a
  /// step, and with tiles
  void set_shape(world::World& world, std::uint32_t mover, const world::ShapeChange& change);
  static constexpr std::size_t kMostShapeChanges = 1'000;  ///< between two steps

  /// Lets controllers of models change shapes in `world`, the one given to the constructor. Without this call they
  /// cannot.
  void change_shapes_in(world::World& world) { shapes_world_ = &world; }

  /// Requests the use of a lane, between two steps (world/roads/lane_control.h). Route controllers replan. With ranks,
  /// all make the same call.
  /// @param lane such as "3.1" @param use a word of world::lane_use_of
  /// @throws base::InputError, with nothing changed, for an unknown lane or use, a use that the lane cannot have, a
  /// world without roads, and with tiles
  void set_lane(const std::string& lane, const std::string& use);
  /// Returns the current uses, one per lane; empty before the first request.
  std::span<const world::LaneUse> lane_uses() const {
    return lanes_ ? lanes_->uses() : std::span<const world::LaneUse>();
  }

  /// Adds a robot to the world and the run, between two steps. Its sensors are read from the next step on. It affects
  /// the readings of others only by its body. A removed robot of the same name and kind returns in its row, with its
  /// id, and continues its random numbers and counts. Takes time in proportion to the fleet and the world. With ranks,
  /// all make the same call.
  /// @param world the one given to the constructor; existing rows remain valid
  /// @return its row, the last one for a new robot
  /// @throws base::InputError, with nothing changed: for a name that is taken or invalid, an unknown original, a pose
  /// that is not finite, invalid settings of its controller, more than world::kMostMovers, and with tiles
  std::uint32_t add_robot(world::World& world, const JoiningRobot& robot);
  /// Removes a robot from the run between two steps. Its row, id and name remain reserved. With ranks, all make the
  /// same call.
  /// @throws base::InputError for a row without a present robot, and with tiles
  void remove_robot(std::uint32_t mover);
  /// Returns the robots that joined, in the order of their rows.
  const std::vector<record::JoinedMover>& joined() const { return joined_; }
  bool is_absent(std::uint32_t mover) const { return absent_[mover]; }
  /// Returns the memory of the readings returned before the last `add_robot`, or before a step that changed outlines;
  /// null after the next step.
  std::shared_ptr<const void> earlier_readings() const { return earlier_readings_; }

  const farm::Farm& farm() const { return farm_; }
  /// Returns the thread pool for the caller's own loops between two steps.
  base::ThreadPool& thread_pool() { return farm_.thread_pool(); }
  double move_seconds() const { return move_s_; }  ///< [s] wall time of controllers and motion

  /// Returns the mover's controller; null for movers without one, and for those of other ranks.
  const control::Controller* controller(std::uint32_t mover) const { return controls_[mover].controller.get(); }
  /// Returns whether the last tick called the mover's controller.
  bool stepped(std::uint32_t mover) const { return controls_[mover].stepped; }
  /// Returns the status of the mover's controller, on any rank, after `settle`.
  ControlStatus status(std::uint32_t mover) const;
  const base::Intent& intent(std::uint32_t mover) const { return next_intents_[mover]; }
  /// Returns the mover's estimate of its own state after the last tick, which it broadcasts from the next tick on.
  const OwnEstimate& estimate(std::uint32_t mover) const { return next_estimates_[mover]; }
  /// Returns whether all active controllers are done, on all ranks after `settle`; false without any, and before the
  /// first tick.
  bool all_done() const;
  const world::RoadNetwork* roads() const { return roads_ ? &*roads_ : nullptr; }
  /// Returns warnings about files read by a controller (a mission), for the first controller that has any.
  const std::vector<world::Warning>& warnings() const { return warnings_; }

 private:
  void refuse_copies(const SimulationOptions& options) const;
  const Actor& actor_of(std::uint32_t mover) const;
  void warn_of_long_ways();
  void warn_of_positioning();
  struct RobotControl {
    std::unique_ptr<control::Controller> controller;  ///< null: the mover remains at rest
    control::SharesMap* sharing = nullptr;            ///< the controller; null: it does not share its map
    double rate = 10.0;                               ///< [Hz]
    bool on_scans = false;                            ///< steps on new scans and on contact instead of at its rate
    bool stepped = false;
    bool driven = false;                     ///< externally (`drive`)
    std::uint64_t begun = 0;                 ///< number of steps at its rate
    std::optional<Mailbox> mailbox;          ///< nullopt: readings arrive immediately
    std::optional<Positioning> positioning;  ///< nullopt: no poses
  };
  RobotControl make_control(std::uint32_t mover, const Actor& actor);
  void use_control(RobotControl control);
  void make_room();
  void take_shapes();
  void check_joining(const world::World& world, const JoiningRobot& robot) const;
  std::uint32_t bring_back(std::uint32_t mover, const JoiningRobot& robot);
  void call_models();
  void move();
  std::span<const base::ReadingBlock> sense(std::int64_t time);
  void receive_inputs(std::int64_t time);
  void sort_by_mover(std::span<const base::ReadingBlock> readings);
  bool index_by_mover(std::span<const base::ReadingBlock> readings);
  std::span<const base::Report> recorded_reports();
  void decide(std::int64_t time);
  void decide_one(std::uint32_t mover, std::int64_t time, unsigned thread);
  void try_to_decide(std::uint32_t mover, std::int64_t time, unsigned thread);
  std::span<const world::Signal> signals_at(std::int64_t time, std::vector<world::Signal>& signals) const;
  std::int64_t leaves_at(const base::ReadingBlock& reading) const;
  bool due(RobotControl& robot, std::span<const base::ReadingBlock> fresh, std::int64_t time, bool contact) const;
  void begin();
  ControlStatus own_status(std::uint32_t mover) const;
  void exchange_maps(control::SharesMap& controller, std::span<const control::Neighbour> others) const;
  Broadcast broadcast_of(const base::Report& truth, std::int64_t time) const;
  void find_others(std::uint32_t mover, std::int64_t time, std::vector<control::Neighbour>& others) const;

  std::unique_ptr<FleetShare> share_;
  const world::World& whole_;  ///< as loaded
  const world::World& world_;  ///< the part that this process needs
  std::optional<world::RoadNetwork> roads_;
  std::optional<world::LaneControl> lanes_;  ///< since the first request
  farm::Farm farm_;
  robots::Fleet fleet_;
  std::optional<StateLink> states_;  ///< nullopt: the farm has the true states
  std::optional<V2vLink> v2v_;       ///< nullopt: V2V is current
  robots::NeighbourGrid neighbours_;
  std::vector<RobotControl> controls_;  ///< per mover
  control::ModelControllers models_;
  std::vector<base::Twist> commands_;
  std::vector<base::Twist> executed_commands_;  ///< executed in the interval before the recorded tick
  /// Readings of this tick: the returned span if already in order, else `sorted_`.
  std::span<const base::ReadingBlock> by_mover_;
  std::vector<std::uint32_t> first_;  ///< per mover: index of its first reading; the last entry is the end
  std::vector<std::uint32_t> next_;   ///< scratch
  std::vector<base::ReadingBlock> sorted_;
  std::vector<base::FaultMark> faults_;       ///< readings measured since the last tick that faults affected
  std::vector<farm::StoredReading> early_;    ///< readings delivered between ticks; slots reuse their memory
  std::vector<base::ReadingBlock> readings_;  ///< `early_` and the tick's; empty if `early_` is
  std::vector<base::Intent> intents_;         ///< per mover, broadcast in this tick
  std::vector<base::Intent> next_intents_;    ///< broadcast from the next tick on
  std::vector<OwnEstimate> estimates_;        ///< as `intents_`
  std::vector<OwnEstimate> next_estimates_;   ///< as `next_intents_`
  std::vector<Broadcast> broadcasts_;         ///< per mover, for `v2v_`
  std::vector<std::shared_ptr<const control::SharedMap>> maps_;       ///< as `intents_`; empty: no robot shares its map
  std::vector<std::shared_ptr<const control::SharedMap>> next_maps_;  ///< as `next_intents_`
  std::vector<std::vector<control::Neighbour>> others_;               ///< per thread
  std::vector<std::vector<world::Signal>> own_signals_;               ///< per thread, of a copy with its own clock
  std::vector<world::Signal> signals_;
  std::vector<base::LightStatus> light_states_;  ///< per light, of the recorded tick
  std::vector<bool> absent_;                     ///< per mover
  std::vector<std::uint32_t> reshaped_;          ///< movers changed since the last step
  std::vector<base::ShapeState> shapes_;         ///< of the recorded tick
  world::World* shapes_world_ = nullptr;         ///< null: controllers change no shapes
  std::size_t shape_changes_ = 0;                ///< since the last step
  bool outlines_changed_ = false;                ///< the farm's tables do not have them yet
  std::vector<base::Report> present_;            ///< reports with kAbsent, of one tick; empty: all are present
  std::vector<world::Warning> warnings_;
  std::mutex failure_lock_;
  std::exception_ptr failure_;                    ///< of a controller in this tick
  std::uint32_t failed_ = world::kNone;           ///< first mover that failed
  double v2v_range_ = 0.0;                        ///< [m] largest of all controllers
  std::shared_ptr<const void> earlier_readings_;  ///< valid until the next step
  std::vector<record::JoinedMover> joined_;
  std::optional<PositioningOptions> positioning_;
  CameraInputs camera_inputs_;
  farm::V2vInputs v2v_inputs_;
  std::vector<base::ReadingBlock> received_;  ///< of one tick: poses of cameras, states by V2V
  Actor actor_;                               ///< default of all robots
  std::vector<Actor> actors_;                 ///< as SimulationOptions::actors
  std::int64_t start_at_;
  std::int64_t interval_;  ///< [ns]
  std::uint64_t tick_ = 0;
  double move_s_ = 0.0;
};

}  // namespace sf::scenarios
