// `run`: simulates a fleet in closed loop, and records or sends its readings on request.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "apps/commands/commands.h"
#include "apps/commands/rank_run.h"
#include "apps/commands/run_maps.h"
#include "apps/commands/run_outputs.h"
#include "apps/commands/run_scenario.h"
#include "apps/commands/run_settings.h"
#include "apps/options/automatic_accuracy.h"
#include "apps/options/bridge_options.h"
#include "apps/options/controller_options.h"
#include "apps/options/default_robot.h"
#include "apps/options/layout_options.h"
#include "apps/options/open_device.h"
#include "apps/processes/checkpoints.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/rate_warnings.h"
#include "apps/reports/report.h"
#include "apps/reports/strayed_robots.h"
#include "apps/reports/text.h"
#include "base/contact_onset.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "base/files.h"
#include "base/hash.h"
#include "cluster/failure.h"
#include "raycast/casters.h"
#include "scenarios/fault_tables.h"
#include "scenarios/operator.h"
#include "scenarios/scenario_events.h"
#include "scenarios/simulation.h"

namespace sf::apps {

namespace {

bool draws_maps(const RunOptions& options) { return !options.map_file.empty() || options.map_view; }

/// True if `refusal` by a controller names one of several driven robots.
bool names_one_of_several(const std::string& refusal, const world::World& world, const RunOptions& options) {
  if (is_scenario(options.world)) return false;
  const std::size_t driven = options.drive.empty() ? count_robots(world) : options.drive.size();
  return driven > 1 && std::any_of(world.movers.begin(), world.movers.end(), [&](const world::Mover& mover) {
           return refusal.find("'" + mover.name + "'") != std::string::npos;
         });
}

/// @throws base::InputError for an invalid file
std::optional<scenarios::PositioningOptions> positioning_of(const RunOptions& options) {
  if (!options.positioning) return std::nullopt;
  const std::string& file = *options.positioning;
  scenarios::PositioningOptions cameras{.position_sigma = 0.005, .yaw_sigma = 0.01};
  if (!file.empty()) cameras = scenarios::parse_positioning(file, base::read_text(file));
  cameras.link.seed = options.seed;
  return cameras;
}

/// @throws base::InputError for an invalid file
std::vector<farm::Fault> faults_of(const RunOptions& options) {
  if (options.fault_file.empty()) return {};
  return scenarios::parse_faults(options.fault_file, base::read_text(options.fault_file));
}

/// @param scenario null: the options define the fleet
scenarios::SimulationOptions simulation_options(const world::World& world, const RunOptions& options,
                                                cluster::Ranks* ranks, const scenarios::Scenario* scenario) {
  scenarios::SimulationOptions simulation;
  if (scenario != nullptr) {
    simulation = scenarios::simulation_of(*scenario, world);
  } else {
    simulation.seed = options.seed;
    simulation.actor.controller = controller_config_of(options);
    simulation.actors = make_actors(world, options);
    simulation.positioning = positioning_of(options);
    simulation.faults = faults_of(options);
  }
  simulation.threads = threads_of(options, ranks);
  simulation.no_return_inf = options.no_return_inf;
  simulation.ranks = ranks;
  simulation.tiles = options.tiles && ranks != nullptr;
  simulation.balance = options.balance;
  return simulation;
}

const char* const kRemedy = "; or name the robots to drive (--drive NAME)";

/// Runs `act()`. If a controller refuses one of several robots, adds a remedy to the error. Some controllers refuse
/// when they are created, others when they start.
template <class Act>
auto advised(const world::World& world, const RunOptions& options, Act&& act) {
  try {
    return act();
  } catch (const base::InputError& error) {
    if (!names_one_of_several(error.what(), world, options)) throw;
    throw base::InputError(std::string(error.what()) + kRemedy);
  } catch (const cluster::Failure& failure) {
    if (!names_one_of_several(failure.what(), world, options)) throw;
    throw cluster::Failure(failure.code(), std::string(failure.what()) + kRemedy);
  }
}

/// World, layout, device and sensors of a run.
struct Ground {
  std::optional<scenarios::Scenario> scenario;
  world::World world;
  std::optional<server::StreamLayout> layout;
  gpu::Device device;
  sensors::SensorSet sensor_set;
  std::string caster;

  /// @param options seed and duration are replaced by the scenario's. @param ranks may be null
  Ground(RunOptions& options, const cluster::Ranks* ranks)
      : scenario(scenario_of(options)),
        world(load(options, ranks)),
        layout(layout_of(world, options)),
        device(open_device(options)),
        sensor_set(with_accuracy(options)),
        caster(raycast::describe_caster(device.info().software)) {
    warn_of_many_times(sensor_set);
    note_size();
    if (options.fault_file.empty()) return;
    const std::vector<farm::Fault> faults = faults_of(options);
    farm::check_faults(faults, world, sensor_set);
    options.faults = scenarios::faults_text(faults);
  }

  /// A world and its packet layout.
  struct Scenery {
    world::World world;
    std::optional<server::StreamLayout> layout;
    std::optional<scenarios::Scenario> scenario = {};
  };
  /// @param file world file; empty: an empty world @throws base::InputError
  Scenery load(const RunOptions& options, const std::string& file) const {
    Scenery scenery;
    scenery.world.interval = world.interval;
    if (file.empty())
      world::update_extent_and_hash(scenery.world);
    else
      scenery.world =
          load_with_robots(source_of(options, file, nullptr), seed_of(options), scenarios::OwnRobot::where_needed);
    scenery.layout = layout_of(scenery.world, options);
    return scenery;
  }
  void swap(Scenery& scenery) {
    std::swap(world, scenery.world);
    std::swap(layout, scenery.layout);
    std::swap(scenario, scenery.scenario);
    sensor_set = sensors::SensorSet(world);
    note_size();
  }
  /// Robots that joined during the run occupy the last rows.
  bool has_joined() const { return world.movers.size() > movers_; }
  void forget_changes() {
    world::restore_originals(world);
    if (!has_joined()) return;
    world.movers.resize(movers_);
    world.models.resize(models_);
    world::update_extent_and_hash(world);
    sensor_set = sensors::SensorSet(world);
  }

 private:
  void note_size() { movers_ = world.movers.size(), models_ = world.models.size(); }
  std::size_t movers_ = 0, models_ = 0;  ///< number of each in the loaded world

  /// Ranks with tiles read outlines once their tile is determined, unless they balance tiles or record, since each then
  /// keeps the whole world.
  static WorldOptions source_of(const RunOptions& options, const std::string& file, const cluster::Ranks* ranks) {
    WorldOptions source = options;
    source.world = file;
    source.load.leave_outlines = ranks != nullptr && options.tiles && options.balance == 0.0 && options.record.empty();
    return source;
  }
  /// Clone options without clones.
  static CloneOptions seed_of(const RunOptions& options) {
    CloneOptions clones;
    clones.seed = options.seed;
    return clones;
  }
  static std::optional<server::StreamLayout> layout_of(const world::World& world, const RunOptions& options) {
    if (options.send.empty()) return std::nullopt;
    return stream_layout_of(world, sensors::SensorSet(world), options);
  }
  world::World load(const RunOptions& options, const cluster::Ranks* ranks) const {
    if (scenario) return load_scenario_world(*scenario, options.load);
    return load_with_robots(source_of(options, options.world, ranks), options);
  }
  const world::World& with_accuracy(const RunOptions& options) {
    choose_accuracy(world, device, options, options.seed, options.threads);
    return world;
  }
};

/// Hash of everything that the results depend on.
std::uint64_t hash_of(const world::World& world, const RunOptions& options) {
  std::string text =
      fmt::format("{} {} {} {} {} {} {}", base::hash_hex(world.hash), world.movers.size(), options.of, options.seed,
                  options.controller, options.localize.value_or(true), options.no_return_inf);
  for (const auto* words : {&options.set, &options.drive})
    for (const std::string& word : *words) text += "\n" + word;
  for (const world::Mover& mover : world.movers) {
    if (mover.controller.empty()) continue;
    text += fmt::format("\n{} {} {} {}", mover.name, mover.controller, options.controller_given, options.keep_ctrl);
    for (const auto& [key, value] : mover.controller_settings) text += fmt::format(" {}={}", key, value);
  }
  if (options.positioning)
    text += "\npositioning " + (options.positioning->empty() ? "" : base::read_text(*options.positioning));
  if (!options.fault_file.empty()) text += "\nfaults " + base::read_text(options.fault_file);
  if (is_scenario(options.world)) text += base::read_text(options.world);
  return base::hash_bytes(text.data(), text.size());
}

/// Kept by the first rank.
std::optional<Checkpoints> checkpoints_of(const world::World& world, const RunOptions& options,
                                          const cluster::Ranks* ranks, const std::string& folder) {
  if ((options.checkpoint == 0.0 && !options.resume) || (ranks != nullptr && ranks->rank() > 0)) return std::nullopt;
  const auto every = options.checkpoint == 0.0 ? 0.0 : std::max(1.0, std::round(options.checkpoint / world.interval));
  return Checkpoints(folder, hash_of(world, options), static_cast<std::uint64_t>(every), options.resume);
}

/// Other ranks record their own readings. Without readings, one recording contains everything.
record::RecordingPart part_of(const RunOptions& options, const cluster::Ranks* ranks) {
  if (ranks == nullptr || !options.record_readings) return {.compression = options.compression};
  return {ranks->rank(), ranks->size(), options.compression};
}

/// Folder of the recording after `resets` resets; each starts a new recording. Empty: this rank does not record.
std::string recording_folder(const RunOptions& options, const cluster::Ranks* ranks, std::uint32_t resets) {
  if (ranks != nullptr && ranks->rank() > 0 && !options.record_readings) return "";
  return options.record.empty() || resets == 0 ? options.record : fmt::format("{}-{}", options.record, resets + 1);
}

/// File of the video after `resets` resets, numbered like the recording.
std::string video_file(const RunOptions& options, std::uint32_t resets) {
  if (options.video.empty() || resets == 0) return options.video;
  std::filesystem::path file(options.video);
  const std::string suffix = file.extension().string();
  return fmt::format("{}-{}{}", file.replace_extension().string(), resets + 1, suffix);
}

/// The simulation of a fleet from time 0, with its metrics, events and outputs.
struct Course {
  const world::World& world;
  cluster::Ranks* ranks;
  scenarios::Simulation simulation;
  ControlMetrics tally;
  std::optional<scenarios::ScenarioEvents> events;
  std::vector<base::ContactOnset> contacts;
  std::vector<base::Intent> intents;  ///< of this tick, for the bridges
  StrayedRobots strayed;
  std::optional<Checkpoints> checkpoints;
  RunOutputs outputs;
  std::optional<RunMaps> maps;
  std::uint64_t ticks = 0;
  std::uint64_t contacts_begun = 0;

  Course(Ground& ground, const RunOptions& options, cluster::Ranks* of, std::uint32_t resets)
      : Course(ground, options, of, resets, simulation_options(ground.world, options, of, scenario_in(ground))) {}

  Course(Ground& ground, const RunOptions& options, cluster::Ranks* of, std::uint32_t resets,
         const scenarios::SimulationOptions& simulated)
      : world(ground.world),
        ranks(of),
        simulation(world, ground.device, simulated),
        tally(simulation, world.movers.size(),
              simulated.actors.empty() ? options.controller : controllers_of(simulated.actors)),
        contacts(world.movers.size()),
        strayed(world),
        checkpoints(checkpoints_of(world, options, ranks, recording_folder(options, ranks, resets))),
        outputs(world, ground.sensor_set, ground.layout, ground.caster, options,
                recording_folder(options, ranks, resets), part_of(options, ranks), video_file(options, resets)) {
    // The simulation has copied the walls of its tile, and a recording begins with all of them.
    if (options.tiles && ranks != nullptr && options.balance == 0.0) ground.world.walls = {};
    simulation.change_shapes_in(ground.world);
    if (ground.scenario) events.emplace(*ground.scenario);
    if (draws_maps(options)) maps.emplace(world, simulation, options.map_file, options.map_view);
    if (ranks == nullptr) simulation.interrupt_on([] { return stop_requested().load(); });
  }

  static const scenarios::Scenario* scenario_in(const Ground& ground) {
    return ground.scenario ? &*ground.scenario : nullptr;
  }

  double simulated() const { return static_cast<double>(ticks) * world.interval; }

  /// Adds a robot that stops until it receives a command. @throws base::InputError, with no change made
  void add(Ground& ground, const bridges::Joining& robot) {
    const std::size_t before = world.movers.size();
    simulation.add_robot(ground.world, {.name = robot.name, .like = robot.like, .X_WM = robot.X_WM});
    if (world.movers.size() > before) grow(ground);  // otherwise an existing robot returned
  }

  /// Applies the scenario events that are due. @throws base::InputError with the line of the event
  void apply_events(Ground& ground, LiveBridges& live) {
    if (!events) return;
    const bool joins = events->joins(simulated());
    if (joins) live.prepare_change();
    events->apply(simulation, ground.world, simulated(), [&](std::uint32_t) { grow(ground); });
    if (joins) live.show_scene(false);
  }

  /// Extends sensors, metrics and outputs by the mover that was added in the last row.
  void grow(Ground& ground) {
    ground.sensor_set = sensors::SensorSet(world);
    contacts.emplace_back();
    tally.add_mover();
    outputs.add_movers(simulation.joined());
  }

  /// Motion and readings of a tick are computed at its end, so readings due during the tick are sent one tick later.
  void step(scenarios::Operator& users) {
    const base::TickRecord tick = simulation.step();
    intents.clear();
    if (users.is_watched())
      for (const base::Report& report : tick.reports) intents.push_back(simulation.intent(report.mover));
    users.publish(tick, intents);
    outputs.write(tick, [&](std::int64_t time) { users.keep_pace(1e-9 * static_cast<double>(time) + world.interval); });
    simulation.settle();
    if (maps) maps->write(tick);
    tally.update(tick);
    strayed.write(tick);
    for (std::size_t m = 0; m < contacts.size(); ++m)
      contacts_begun += !world.movers[m].is_tag && contacts[m].begins(tick.contacts[m] != 0);
    ++ticks;
    if (checkpoints) checkpoints->update(ticks, simulation.farm().hash(), tick.reports);
  }

  void report(RunReport& facts) {
    facts.ticks = ticks;
    facts.simulated_s = simulated();
    facts.contacts = contacts_begun;
    facts.strayed = strayed.names();
    facts.control = tally.facts(world, ranks);
    facts.move_s = simulation.move_seconds();
    facts.farm = simulation.farm().stats();
    facts.hash = simulation.farm().hash();
    outputs.finish(facts);
    if (maps) maps->finish();
    if (ranks != nullptr) add_up(*ranks, facts, simulation.share().passed_on());
  }
};

constexpr double kWithoutEnd = std::numeric_limits<double>::infinity();

/// [1] Ratio of simulated to real time. @param watched users are connected through bridges
double speed_of(const RunOptions& options, bool watched) {
  const double speed = options.speed.value_or(watched ? 1.0 : 0.0);
  return speed > 0.0 ? speed : std::numeric_limits<double>::infinity();
}

/// Runs `act()` and stores its error in the outcome.
template <class Act>
void attempt(bridges::Outcome& outcome, bridges::Outcome::Fault fault, Act&& act) {
  outcome.done = true;
  try {
    act();
  } catch (const base::InputError& error) {
    outcome = {true, fault, error.what()};
  } catch (const base::DeviceError& error) {
    outcome = {true, fault, error.what()};
  }
}

void change_fleet(Course& course, Ground& ground, LiveBridges& live, const std::vector<bridges::Joining>& joining,
                  const std::vector<bridges::Leaving>& leaving) {
  using Fault = bridges::Outcome::Fault;
  for (const bridges::Leaving& each : leaving)
    attempt(*each.outcome, Fault::failed, [&] { course.simulation.remove_robot(each.mover); });
  if (joining.empty()) return;
  live.prepare_change();
  for (const bridges::Joining& each : joining) attempt(*each.outcome, Fault::failed, [&] { course.add(ground, each); });
  live.show_scene(false);
}

int simulate(RunOptions options, cluster::Ranks* ranks) {
  std::optional<Ground> ground;
  std::optional<Course> course;
  std::optional<LiveBridges> live;
  const auto begin = [&](std::uint32_t resets) {
    course.reset();
    advised(ground->world, options, [&] { course.emplace(*ground, options, ranks, resets); });
  };
  on_all(ranks, [&] {
    if (ranks != nullptr) check_for_ranks(options);
    ground.emplace(options, ranks);
    begin(0);
    install_stop_handlers();  // before addresses are printed, which scripts wait for
    live.emplace(options, ground->world, ground->sensor_set, run_settings(options, ground->caster, true), true);
  });
  if (live->empty()) print_taken_names(course->outputs.taken_names());
  std::vector<world::Warning> heard = course->simulation.warnings();
  for (world::Warning& warning : course->simulation.share().warnings_of_starts()) heard.push_back(std::move(warning));
  if (!heard.empty()) print_warnings(heard.front().file, heard);
  std::atomic<bool> all_stop = false;
  scenarios::Operator users(live->bridges(), ranks != nullptr ? all_stop : stop_requested(),
                            speed_of(options, !live->empty() || options.map_view));
  if (ranks == nullptr) {
    users.on_fleet_changes(
        [&](const auto& joining, const auto& leaving) { change_fleet(*course, *ground, *live, joining, leaving); });
    users.set_loads_worlds(true);
  }
  const auto reset = [&] {
    users.begin_again();
    course.reset();
    if (!ground->has_joined() && ground->world.changed_shapes.empty()) return begin(users.resets());
    live->prepare_change();
    ground->forget_changes();
    begin(users.resets());
    live->show_scene(true);
  };
  /// Changes the world on a user's request. If the change fails, the run continues.
  const auto change_world = [&] {
    const bridges::WorldChange change = users.take_world();
    using Fault = bridges::Outcome::Fault;
    Ground::Scenery next;
    attempt(*change.outcome, Fault::unreadable, [&] { next = ground->load(options, change.file); });
    if (change.outcome->fault != Fault::none) return;
    if (change.strict && !next.world.warnings.empty()) {
      const world::Warning& first = next.world.warnings.front();
      *change.outcome = {true, Fault::unsupported, fmt::format("{}:{}: {}", first.file, first.line, first.message)};
      return;
    }
    course.reset();
    live->prepare_change();
    ground->forget_changes();
    ground->swap(next);
    users.begin_again();
    attempt(*change.outcome, Fault::failed, [&] { begin(users.resets()); });
    if (change.outcome->fault != Fault::none) {
      ground->swap(next);
      begin(users.resets());
    }
    users.pause();
    live->show_scene(true);
  };
  const bool watched = !live->empty() || options.map_view;
  const double duration = options.duration.value_or(watched ? kWithoutEnd : 60.0);
  const double ticks = std::round(duration / ground->world.interval);
  if (ticks < 1.0)
    print_message(
        "--duration {:g} simulates nothing, since a tick takes {:g} s; give a longer duration, or leave it out for 60 "
        "s (unlimited with bridges)",
        duration, ground->world.interval);
  if (options.tiles && ranks == nullptr)
    print_message("--tiles has no effect in one process: start several (mpirun -n N sensorfarm run ...)");
  RunReport facts;
  const auto start = std::chrono::steady_clock::now();
  {
    Progress progress("simulating");
    auto next = scenarios::Operator::Next::tick;
    while (static_cast<double>(course->ticks) < ticks) {
      next = users.wait(course->simulation, course->simulated());
      if (next == scenarios::Operator::Next::stop) break;
      if (next == scenarios::Operator::Next::reset) {
        reset();
        continue;
      }
      if (next == scenarios::Operator::Next::world) {
        change_world();
        continue;
      }
      if (stop_requested()) course->simulation.share().request_stop();
      try {
        course->apply_events(*ground, *live);
        advised(ground->world, options, [&] { course->step(users); });
      } catch (const base::Interrupted&) {
        next = scenarios::Operator::Next::stop;
        break;
      }
      all_stop = course->simulation.share().stop_agreed();
      const double simulated = course->simulated();
      if (duration < kWithoutEnd && (ranks == nullptr || ranks->rank() == 0))
        progress.show(simulated / duration, fmt::format("{:.0f} s of {:g} s", simulated, duration));
    }
    facts.interrupted = next == scenarios::Operator::Next::stop;
    users.keep_pace(course->simulated());  // a tick lasts until the start of the next
  }
  facts.wall_s = base::seconds_since(start);
  const gpu::DeviceInfo& device = ground->device.info();
  facts.device = device.name;
  facts.software = device.software;
  facts.caster = ground->caster;
  facts.robots = static_cast<std::uint32_t>(count_robots(ground->world));
  course->report(facts);
  std::vector<world::Warning> warnings = ground->world.warnings;
  warnings.insert(warnings.end(), heard.begin(), heard.end());
  print(options.json ? with_warnings(run_report_json(facts), warnings) : run_report_text(facts));
  print_never_valid(course->simulation.farm().never_valid());
  const netio::OutboxCounts& packets = facts.publisher.packets;
  // A run without a duration is complete when its user ends it.
  if (packets.failed == 0) return facts.interrupted && duration < kWithoutEnd ? interrupted_code() : 0;
  print_message("{} of {} packets were not sent: {}", packets.failed, packets.queued, packets.first_failure);
  return 1;
}

}  // namespace

int run(const RunOptions& options) {
  return with_ranks([&](cluster::Ranks* ranks) { return simulate(options, ranks); });
}

}  // namespace sf::apps
