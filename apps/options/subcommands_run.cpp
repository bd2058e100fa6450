// Subcommands that run: the farm, robots, receivers.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "apps/commands/commands.h"
#include "apps/commands/run_scenario.h"
#include "apps/options/option_groups.h"
#include "apps/options/option_parsers.h"
#include "apps/options/subcommands.h"
#include "base/installation.h"
#include "server/real_robot.h"

namespace sf::apps {

namespace {

/// Names of the options that add_ports adds: --laser-port and so on, --ports-per-robot and --wire.
std::vector<std::string> names_of_ports(const CLI::App& sub) {
  std::vector<std::string> names;
  for (const CLI::Option* option : sub.get_options()) {
    const std::string name = option->get_name();
    if ((name != "--port" && name.ends_with("-port")) || name == "--ports-per-robot" || name == "--wire")
      names.push_back(name);
  }
  return names;
}

/// Rejects options that a scenario file defines itself.
void refuse_options_of_worlds(const CLI::App& run) {
  const auto world = run.get_option("world")->as<std::string>();
  if (!is_scenario(world)) return;
  for (const auto& [option, key] : {std::pair{"--robots", "robots"},
                                    {"--of", "of"},
                                    {"--robot-from", "world"},
                                    {"--seed", "seed"},
                                    {"--controller", "controller"},
                                    {"--set", "settings"},
                                    {"--localize", "settings"},
                                    {"--positioning", "positioning"},
                                    {"--faults", "[[fault]]"},
                                    {"--drive", "controller"}})
    if (run.count(option) > 0)
      throw CLI::ValidationError(option, fmt::format("applies to worlds; a scenario sets `{}`: change {}", key, world));
}

/// Bridges offer raw images in any case.
void check_images(const CLI::App& sub, const std::string& recorded) {
  if (sub.count("--images") == 0 || sub.count(recorded) > 0) return;
  const auto word = sub.get_option("--images")->as<std::string>();
  if (word == "raw" || word == "both") throw CLI::ValidationError("--images", word + " needs " + recorded);
  if (sub.count("--ros2") + sub.count("--view") == 0)
    throw CLI::ValidationError("--images", "needs " + recorded + ", --ros2 or --view");
}

void check_run(const CLI::App& run) {
  check_images(run, "--record-readings");
  refuse_options_of_worlds(run);
  check_naming(run, "--record-readings");
  require_any(run, names_of_ports(run), {"--send"});
}

void add_run(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("run", "Simulate a fleet with its sensors and controllers, as fast as possible");
  auto& o = add_command(*sub, call, run, [sub] { check_run(*sub); });
  add_examples(*sub, {"worlds/cave.world --robots 50 --duration 30", "worlds/cave.world --robots 4 --record out/run",
                      "worlds/cave.world --robots 9 --duration 20 --video run.webm",
                      "worlds/cave.world --robots 4 --send 127.0.0.1 --real-time", "experiments/simville.toml --view"});
  add_world(*sub, o);
  sub->get_option("world")->description("World file (.world of Stage, .yaml of ROS maps), or scenario (.toml)");
  add_accuracy(*sub, o);
  add_automatic(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_robots(*sub, o);
  add_robot_from(*sub, o);
  add_controller(*sub, o);
  sub->add_option("--drive", o.drive, "Robot to drive; all others stay at rest (may be repeated; default: every robot)")
      ->check(not_empty("the name of a robot"))
      ->allow_extra_args(false)
      ->type_name("NAME");
  sub->add_flag("--keep-ctrl", o.keep_ctrl,
                "Robots with `ctrl` in the world file keep that controller; --controller drives the others");
  sub->add_option("--positioning", o.positioning,
                  "Overhead cameras for robots that localize themselves, as in the file's keys of [positioning] "
                  "(docs/scenarios.md; default: 10 poses/s, 5 mm, 0.01 rad)")
      ->expected(0, 1)
      ->type_name("[FILE]");
  sub->add_option("--faults", o.fault_file, "Faults of sensors: a file with [[fault]] tables (docs/scenarios.md)")
      ->check(not_empty("a file"))
      ->type_name("FILE");
  add_no_return(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--duration", o.duration, "Simulated time [s] (default: 60; unlimited with bridges)")
      ->check(in_seconds(0.0, 1e9))
      ->type_name("S");
  add_threads(*sub, o);
  auto* record = sub->add_option("--record", o.record, "Folder for the recording of the run (run.mcap)")
                     ->check(not_empty("a folder"))
                     ->type_name("DIR");
  sub->add_flag("--record-readings", o.record_readings,
                "Also record the readings, not only the states from which they can be recomputed")
      ->needs(record);
  add_images(*sub, o);
  add_compression(*sub, o)->needs(record);
  sub->add_option("--checkpoint", o.checkpoint,
                  "Write a checkpoint of the run every S simulated seconds (with --record)")
      ->check(in_seconds(0.001, 1e9))
      ->needs(record)
      ->type_name("S");
  sub->add_flag("--resume", o.resume,
                "Recompute an interrupted run, with the same bytes, and compare it with its checkpoints")
      ->needs(record);
  auto* map_file =
      sub->add_option("--map-file", o.map_file,
                      "Draw the map that the robots build, merged, into this picture (.png, .svg or .pdf), which is "
                      "replaced as the map grows")
          ->check(replaced_picture())
          ->type_name("FILE");
  auto* map_view = add_live_view(*sub, o.map_view, "a page with the maps that the robots build", "--map-view");
  add_video(*sub, o, "Video of the run to write (VP9 in WebM, encoded by FFmpeg)");
  for (CLI::Option* map : {map_file, map_view}) map->excludes("--video");  // which draws on another thread
  auto* tiles =
      sub->add_flag("--tiles", o.tiles, "Divide the world into tiles: each rank (mpirun) holds and senses one");
  sub->add_option("--balance", o.balance, "Rebalance the tiles every S simulated seconds by the time that they take")
      ->check(in_seconds(0.001, 1e9))
      ->needs(tiles)
      ->type_name("S");
  auto* speed =
      sub->add_option("--speed", o.speed,
                      "Ratio of simulated to real time (0: as fast as possible; default: 0, or 1 with bridges)")
          ->check(number(0.0, 1e6))
          ->type_name("X");
  sub->add_flag_callback(
         "--real-time", [&o] { o.speed = 1.0; }, "Run in real time: --speed 1")
      ->excludes(speed);
  add_bridges(*sub, o);
  add_naming(*sub, o);
  sub->add_option("--send", o.send, "Send every reading as UDP packets to this host")
      ->check(not_empty("a host"))
      ->type_name("HOST");
}

void add_forget(CLI::App& app, ForgetOption& o) {
  app.add_option("--forget", o.forget,
                 "Silence after which a robot is no longer an obstacle [s], at least 2 (0: never)")
      ->check(in_seconds(0.0, 1e9))
      ->check([](const std::string& text) {
        return std::stod(text) == 0.0 || std::stod(text) >= 2.0 ? "" : text + " is below 2 (0: never)";
      })
      ->type_name("S")
      ->capture_default_str();
}

constexpr const char* kStatesGroup = "States of robots and tags (docs/estimation.md)";

CLI::Option* add_clock(CLI::App& app, const std::string& name, estimation::ClockSource& clock) {
  using estimation::ClockSource;
  return add_choice<ClockSource, ClockSource>(
             app, name, clock,
             {{"estimated", ClockSource::estimated},
              {"trusted", ClockSource::trusted},
              {"arrival", ClockSource::arrival}},
             "Time of states: timestamps on clocks that are estimated from the packets or trusted (Unix time, "
             "synchronized by PTP or NTP), or the time of arrival")
      ->default_str("estimated");
}

void add_filter(CLI::App& app, FilterOptions& o) {
  using estimation::StalePolicy;
  constexpr const char* kGroup = kStatesGroup;
  app.add_option("--stale-after", o.stale_after,
                 "Age at which a robot's state is stale, which its readings then state [s]")
      ->check(in_seconds(0.01, 1e6))
      ->type_name("S")
      ->capture_default_str()
      ->group(kGroup);
  app.add_flag(
         "--keep-heights", o.keep_heights,
         "Robots and tags keep the heights of the world file, whatever z their states have (default: z moves them "
         "up and down)")
      ->group(kGroup);
  auto* filter =
      app.add_flag("--filter", o.filter,
                   "Filter all states with an extended Kalman filter: late states are applied at their timestamps, "
                   "outliers are rejected, and each reading uses the state predicted to its time (default: only "
                   "states of senders whose states arrive late by changing amounts)")
          ->group(kGroup);
  auto* raw = app.add_flag("--raw", o.raw,
                           "Use the newest state as of its arrival, without a filter, and leave stale robots and tags "
                           "in place (--stale freeze)")
                  ->excludes(filter)
                  ->group(kGroup);
  add_choice<std::optional<StalePolicy>, StalePolicy>(
      app, "--stale", o.stale,
      {{"freeze", StalePolicy::freeze}, {"hide", StalePolicy::hide}, {"drop", StalePolicy::drop}},
      "Stale robots and tags stay in place (freeze), leave the world (hide), or leave it and lose their sender's clock "
      "estimate (drop)")
      ->default_str("hide")
      ->group(kGroup);
  const auto given = [&o](const std::string&) { o.unix_time = false; };
  add_clock(app, "--clock", o.clock)->each(given)->excludes(raw)->group(kGroup);
  app.add_option("--link-delay", o.link_delay,
                 "Minimum delay of packets to the farm [s], which packets do not reveal (--clock estimated)")
      ->check(in_seconds(0.0, 10.0))
      ->each(given)
      ->excludes(raw)
      ->type_name("S")
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--hypotheses", o.hypotheses,
                 "Number of Gaussians for a state whose heading is uncertain after losses; with 1, the covariance is "
                 "too small then")
      ->check(whole(1, 64))
      ->excludes(raw)
      ->type_name("N")
      ->capture_default_str()
      ->group(kGroup);
}

/// Rejects options of `serve` that have no effect if the farm moves the robots.
void refuse_with_lockstep(const CLI::App& sub) {
  if (sub.count("--lockstep") == 0) return;
  const std::vector<std::string> ports = names_of_ports(sub);
  for (const CLI::Option* option : sub.get_options()) {
    const std::string name = option->get_name();
    const bool of_ports = std::find(ports.begin(), ports.end(), name) != ports.end();
    if (option->count() > 0 &&
        (of_ports || name == "--spat" || name == "--stale-lights" || name == "--rate" || name == "--radio" ||
         name == "--forget" || name == "--mirror" || name == "--own-age" || name == "--processor-budget" ||
         name == "--network-budget" || option->get_group() == kStatesGroup || option->get_group() == kBridgeGroup))
      throw CLI::ValidationError(name, "cannot be used with --lockstep");
  }
}

void check_serve(const CLI::App& sub) {
  if (sub.count("--clock") > 0 && sub.count("--filter") == 0 &&
      sub.get_option("--clock")->as<std::string>() == "arrival")
    throw CLI::ValidationError("--clock", "arrival needs --filter: lateness is detected by timestamps");
  refuse_with_lockstep(sub);
  check_images(sub, "--record");
  check_naming(sub);
  if (sub.count("--link-delay") > 0 && sub.count("--clock") > 0 &&
      sub.get_option("--clock")->as<std::string>() != "estimated")
    throw CLI::ValidationError("--link-delay", "applies to estimated clocks only: leave out --link-delay or --clock");
}

void add_lockstep(CLI::App& app, ServeOptions& o) {
  constexpr const char* kGroup = "Lockstep (docs/packets.md)";
  auto* lockstep = app.add_flag("--lockstep", o.lockstep,
                                "Simulate the robots: clients command them tick by tick (COMMAND, STEP), as fast as "
                                "the machine allows, with the same readings in every run")
                       ->group(kGroup);
  app.add_option("--wait-for", o.wait_for, "Number of robots that clients must subscribe before the first tick")
      ->check(whole(1, 65536))
      ->needs(lockstep)
      ->type_name("N")
      ->capture_default_str()
      ->group(kGroup);
  app.add_option("--lockstep-timeout", o.lockstep_timeout,
                 "Longest wait for a client [s]; then its robots stop and are left out, the others continue, and the "
                 "exit code is 1 (0: wait forever)")
      ->check(in_seconds(0.0, 1e6))
      ->needs(lockstep)
      ->type_name("S")
      ->capture_default_str()
      ->group(kGroup);
}

void add_serve(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "serve", "Serve virtual sensors to robots in other processes: V2V packets in, sensor packets out");
  auto& o = add_command(*sub, call, serve, [sub] { check_serve(*sub); });
  add_examples(*sub, {"worlds/rooms.world", "worlds/rooms.world --bind 0.0.0.0 --port 9001",
                      "worlds/rooms.world --filter --record out/service", "worlds/cave.world --lockstep --robots 50"});
  add_world(*sub, o);
  add_accuracy(*sub, o);
  add_automatic(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_no_return(*sub, o);
  add_ports(*sub, o);
  add_bind(*sub, o);
  sub->add_option("--port", o.port, "UDP port to listen on (0: any free one)")
      ->check(whole(0, 65535))
      ->type_name("PORT")
      ->capture_default_str();
  sub->add_option("--rate", o.rate,
                  "Ticks per second; if given, sensors are read only at ticks (default: the world's interval_sim, with "
                  "sensors read at their own times)")
      ->check(number(0.1, 10000.0))
      ->type_name("HZ");
  sub->add_option("--radio", o.radio, "Radio range of V2V [m]: states of robots within it are relayed (0: none)")
      ->check(number(0.0, 1e9))
      ->type_name("M")
      ->capture_default_str();
  add_forget(*sub, o);
  add_peers(*sub, o);
  add_lockstep(*sub, o);
  sub->add_option("--join", o.join,
                  "What may join: copies of the world's robot, object or light NAME with the ids FIRST to LAST (of "
                  "robots, tags or intersections), each in the world from its first state until it leaves or is silent "
                  "for 2 s; may be repeated")
      ->excludes("--lockstep")
      ->type_name("NAME=FIRST-LAST");
  add_filter(*sub, o);
  sub->add_option("--own-age", o.own_age,
                  "Age up to which a reading of a real robot's own sensor is fused with those of the virtual one [s]")
      ->check(in_seconds(0.001, 1e6))
      ->type_name("S")
      ->capture_default_str();
  sub->add_option("--mirror", o.mirror,
                  "Address of an observer that receives a copy of every reading packet (`vps --readings`)")
      ->check(not_empty("HOST:PORT"))
      ->type_name("HOST:PORT");
  sub->add_option("--processor-budget", o.processor_budget,
                  "Processor time for readings per tick [ms]; beyond it, readings of sensors with a low `priority` are "
                  "dropped, and their robots notified (0: no limit)")
      ->check(number(0.0, 1e6))
      ->type_name("MS")
      ->capture_default_str();
  sub->add_option("--network-budget", o.network_budget,
                  "Bytes of readings' packets per second, with the same consequence (0: no limit)")
      ->check(number(0.0, 1e12))
      ->type_name("BYTES")
      ->capture_default_str();
  sub->add_option("--spat", o.spat,
                  "UDP port to receive SPaT of traffic lights on, which overrides the world's plans, as V2I at the "
                  "farm's port does")
      ->check(whole(1, 65535))
      ->type_name("PORT");
  using server::StaleLights;
  add_choice<StaleLights, StaleLights>(
      *sub, "--stale-lights", o.stale_lights, {{"dark", StaleLights::dark}, {"plan", StaleLights::plan}},
      "State of a received light after 2 s of silence: dark, which robots treat as a stop sign, or by the world's plan")
      ->default_str("dark");
  auto* record = sub->add_option("--record", o.record,
                                 "Folder for the recording of states, their quality, and readings (run.mcap)")
                     ->check(not_empty("a folder"))
                     ->type_name("DIR");
  add_images(*sub, o);
  add_compression(*sub, o)->needs(record);
  add_robots(*sub, o);
  add_robot_from(*sub, o);
  add_bridges(*sub, o);
  add_naming(*sub, o);
  add_until(*sub, o, "Stop after this long [s] (0: at Ctrl-C)");
}

void add_farm(CLI::App& app, FarmOptions& o) {
  app.add_option("--server", o.server, "Host of the farm (`sensorfarm serve`)")
      ->check(not_empty("a host"))
      ->type_name("HOST")
      ->capture_default_str();
  app.add_option("--port", o.port, "UDP port of the farm")
      ->check(whole(1, 65535))
      ->type_name("PORT")
      ->capture_default_str();
}

void add_link(CLI::App& app, LinkOptions& o) {
  constexpr const char* kGroup = "Faults injected into the link";
  app.add_option("--delay", o.delay, "Injected delay of every packet, in each direction [s]")
      ->check(in_seconds(0.0, 3600.0))
      ->type_name("S")
      ->group(kGroup);
  app.add_option("--jitter", o.jitter,
                 "Additional random delay, uniform from 0 to this [s]; packets may overtake each other")
      ->check(in_seconds(0.0, 3600.0))
      ->type_name("S")
      ->group(kGroup);
  const auto add_fraction = [&](const char* name, double& value, const char* text) {
    app.add_option(name, value, text)->check(number(0.0, 1.0))->type_name("P")->group(kGroup);
  };
  add_fraction("--loss", o.loss, "Fraction of packets lost in each direction, 0 to 1");
  add_fraction("--duplicate", o.duplicate, "Fraction of packets that are duplicated, 0 to 1");
  add_fraction("--corrupt", o.corrupt, "Fraction of packets with one flipped bit, 0 to 1");
}

void add_cameras(CLI::App& app, RobotOptions& o) {
  constexpr const char* kGroup = "The robot's own position (docs/robots.md)";
  auto* cameras = app.add_option("--cameras", o.cameras,
                                 "UDP port for TAG packets (`sensorfarm vps --send`): the robot drives by and reports "
                                 "the pose estimated from them and from its wheels (--set localize=false: from them "
                                 "alone)")
                      ->check(whole(1, 65535))
                      ->type_name("PORT")
                      ->group(kGroup);
  add_clock(app, "--clock", o.camera_clock)->needs(cameras)->group(kGroup);
  app.add_option("--tag", o.tag, "Id of the robot's tag (default: the robot's id)")
      ->check(whole(1, 65535))
      ->type_name("ID")
      ->group(kGroup);
  app.add_option("--lost-beyond", o.most_sigma,
                 "Standard deviation of the estimated position beyond which a robot with wheel encoders stops [m] "
                 "(default: 0.5 with --cameras, else none)")
      ->check(number(0.001, 1000.0))
      ->type_name("M")
      ->group(kGroup);
  app.add_option("--truth", o.truth,
                 "Send the true state to a renderer of camera images (`sensorfarm vps --robots PORT`); the clocks of "
                 "both machines must agree")
      ->check(not_empty("HOST:PORT"))
      ->type_name("HOST:PORT")
      ->group(kGroup);
}

void add_direct_v2v(CLI::App& app, RobotOptions& o) {
  constexpr const char* kGroup = "V2V without the farm (docs/robots.md)";
  app.add_option("--v2v-peers", o.v2v_peers, "Send each V2V to these robots, too, and accept theirs")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(not_empty("HOST:PORT"))
      ->type_name("HOST:PORT,...")
      ->group(kGroup);
  app.add_option("--v2v-group", o.v2v_group, "Send each V2V to this multicast group, too, and accept those sent to it")
      ->check(not_empty("ADDRESS:PORT"))
      ->type_name("ADDRESS:PORT")
      ->group(kGroup);
  app.add_option("--v2v-port", o.v2v_port,
                 fmt::format("UDP port to receive them on (default: {} with --v2v-peers, else any)", kDirectV2vPort))
      ->check(whole(1, 65535))
      ->type_name("PORT")
      ->group(kGroup);
  app.add_option("--v2v-interface", o.v2v_interface,
                 "IPv4 address of the interface for them (default: any, and by the route for --v2v-group)")
      ->check(not_empty("an address"))
      ->type_name("ADDR")
      ->group(kGroup);
  app.add_option("--radio", o.radio, "Radio range [m]: states from farther away are ignored")
      ->check(number(0.001, 1e8))
      ->type_name("M")
      ->capture_default_str()
      ->group(kGroup);
}

void add_robot(CLI::App& app, Call& call) {
  CLI::App* sub =
      app.add_subcommand("robot",
                         "Run one robot in its own process, simulated or real (on a serial line or behind a Player "
                         "server), with sensors served by a farm (exit code 1 if the farm sends nothing)");
  auto& o = add_command(*sub, call, robot, [sub] {
    require_any(*sub, {"--tag"}, {"--cameras", "--truth"});
    require_any(*sub, {"--v2v-port", "--v2v-interface", "--radio"}, {"--v2v-peers", "--v2v-group"});
  });
  add_examples(*sub, {"worlds/testpath/testpath.world --name roomba0 --controller lane-keeping --duration 30",
                      "worlds/rooms.world --name roomba1 --server 192.168.1.5 --loss 0.1 --delay 0.05"});
  add_world(*sub, o);
  add_json(*sub, o);
  add_controller(*sub, o);
  add_farm(*sub, o);
  add_link(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--name", o.robot, "Name of the robot in the world")->required()->type_name("NAME");
  add_robot_from(*sub, o);
  sub->add_option("--rate", o.rate, "Decisions and packets per second (default: the controller's rate)")
      ->check(number(0.1, 1000.0))
      ->type_name("HZ");
  sub->add_option("--stop-after", o.stop_after, "Silence of the farm after which the robot stops [s] (0: never)")
      ->check(in_seconds(0.0, 1e9))
      ->type_name("S")
      ->capture_default_str();
  sub->add_flag("--stop-without-farm", o.stop_without_farm,
                "Stop then even if the controller needs no readings of the farm");
  add_forget(*sub, o);
  add_peers(*sub, o);
  sub->add_option(
         "--spat", o.spat,
         "UDP port to receive SPaT of traffic lights on (`sensorfarm light`, 9010), instead of the farm's lights")
      ->check(whole(1, 65535))
      ->type_name("PORT");
  add_cameras(*sub, o);
  sub->add_option("--map", o.map,
                  "Build a map from the robot's own scans and send it to this address (`sensorfarm map --listen PORT`)")
      ->check(not_empty("HOST:PORT"))
      ->type_name("HOST:PORT");
  sub->add_option(
         "--map-file", o.map_file,
         "Build this map and draw it into this picture (.png, .svg or .pdf), which is replaced as the map grows")
      ->check(replaced_picture())
      ->type_name("FILE");
  add_live_view(*sub, o.view, "a page with this map as a picture");
  auto* serial = sub->add_option("--serial", o.serial, "Serial line of a real robot, which replaces the simulated one")
                     ->check(not_empty("a device such as /dev/ttyUSB0"))
                     ->type_name("DEVICE");
  std::vector<std::string> types;
  for (const server::RealRobotType& type : server::real_robot_types())
    if (!type.behind_server && !type.emulated) types.emplace_back(type.word);
  add_choice(
      *sub, "--robot-type", types, [&o](const std::string& word) { o.robot_type = word; },
      "Type of the real robot: iRobot Create or Create 2, Pioneer 3 (ARCOS), Khepera II")
      ->needs(serial)
      ->default_str("create");
  sub->add_option("--baud", o.baud,
                  "Speed of the serial line (default: create 57600, create2 115200, pioneer and khepera 9600)")
      ->check(one_of({"9600", "19200", "38400", "57600", "115200"}))
      ->needs(serial)
      ->type_name("BAUD");
  sub->add_option("--player", o.player,
                  "Player server of a real robot (position2d:0), which replaces the simulated one")
      ->check(not_empty("HOST:PORT"))
      ->excludes(serial)
      ->type_name("HOST:PORT");
  sub->add_option(
         "--real-world", o.real_world,
         "World file of an emulated real robot, which replaces the simulated one: it drives among the walls of "
         "this file, and its own laser, sonars, infrared and bumpers read these alone")
      ->check(not_empty("a world file"))
      ->excludes("--serial")
      ->excludes("--player")
      ->type_name("FILE");
  sub->add_flag("--keep-readings", o.keep_readings,
                "Do not send a real robot's own readings to the farm, which fuses them with the virtual ones");
  add_direct_v2v(*sub, o);
  sub->add_flag("--wait-for-start", o.wait_for_start, "Wait for the start signal before driving (`sensorfarm start`)");
  add_seed(*sub, o, "Seed of decisions and of injected faults");
  add_until(*sub, o, "Stop after this long [s] (0: when done, or at Ctrl-C)");
}

void add_light(CLI::App& app, Call& call) {
  CLI::App* sub =
      app.add_subcommand("light",
                         "Send the traffic lights of a world or a plan as SAE J2735 messages over UDP, like real "
                         "traffic lights (SPaT at a rate, MAP once a second), and as V2I to a farm");
  auto& o = add_command(*sub, call, light, [sub] {
    require_any(*sub, {"--port", "--latitude", "--longitude"}, {"--send"});
    require_any(*sub, {"--peers"}, {"--farm"});
  });
  add_examples(*sub, {"worlds/simville/simville.world --send 127.0.0.1",
                      "worlds/simville/simville.world --send 192.168.1.7 --set 'light1=flashing red'",
                      "worlds/simville/lights.toml --farm 127.0.0.1:9000"});
  sub->add_option("file", o.file, "World file with the lights and their plans, or a plan (.toml) that names its world")
      ->required()
      ->transform(base::installed_file)
      ->type_name("FILE");
  sub->add_option("--send", o.send, "Host to send SPaT and MAP to")->check(not_empty("a host"))->type_name("HOST");
  sub->add_option("--farm", o.farm,
                  "Farm (`sensorfarm serve`) to send V2I to, and to receive robot states from for the plan's detectors")
      ->check(not_empty("HOST:PORT"))
      ->type_name("HOST:PORT");
  add_peers(*sub, o);
  sub->add_option("--port", o.ports, "UDP port of the receiver; may be repeated for several receivers")
      ->check(whole(1, 65535))
      ->allow_extra_args(false)
      ->type_name("PORT")
      ->capture_default_str();
  sub->add_option("--first-id", o.first_id,
                  "Id of the first intersection, for a light that joins a farm (`serve --join`); others follow")
      ->check(CLI::Range(0u, netio::kMaxId));
  sub->add_option("--rate", o.rate, "SPaT and V2I messages per second for each intersection")
      ->check(number(0.1, 100.0))
      ->type_name("HZ")
      ->capture_default_str();
  sub->add_option("--time", o.time, "Time of the plans at the start [s]")
      ->check(in_seconds(0.0, 1e9))
      ->type_name("S")
      ->capture_default_str();
  sub->add_option("--set", o.set,
                  "Hold a light in one state, overriding its plan: green, yellow, red, flashing red, flashing yellow "
                  "or dark; may be repeated")
      ->check(readable(read_setting, "NAME=STATE such as 'light1=flashing red'"))
      ->allow_extra_args(false)
      ->type_name("NAME=STATE");
  add_origin(*sub, o);
  add_until(*sub, o, "Stop after this long [s] (0: at Ctrl-C)");
}

void add_start(CLI::App& app, Call& call) {
  CLI::App* sub =
      app.add_subcommand("start", "Send the start signal to waiting robots through the farm (not acknowledged)");
  auto& o = add_command(*sub, call, start);
  add_examples(*sub, {"--robot 2"});
  add_farm(*sub, o);
  add_peers(*sub, o);
  sub->add_option("--robot", o.start_id, "Id of the robot (default: all)")->check(whole(0, 65535))->type_name("ID");
}

void add_object(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("object",
                                     "Open and close doors: remove an object from a farm's world, put it back, or "
                                     "change its shape, colour or size (not "
                                     "acknowledged)");
  auto& o = add_command(*sub, call, object);
  add_examples(*sub, {"absent --tag 3", "present --tag 3 --server 192.168.1.5",
                      "present --tag 3 --shape crate --color red --size 1,0.5,0.4"});
  add_farm(*sub, o);
  add_peers(*sub, o);
  using State = ObjectOptions::State;
  add_choice<State, State>(*sub, "state", o.state, {{"present", State::present}, {"absent", State::absent}},
                           "New state of the object")
      ->required();
  sub->add_option("--tag", o.tag, "Id of the object's tag (tag<ID> in the world file)")
      ->required()
      ->check(whole(netio::kMinTag, netio::kMaxId))
      ->type_name("ID");
  sub->add_option("--shape", o.shape,
                  "New shape: a shape( ) of the farm's world, with its size and colour, or 'original' (default: "
                  "unchanged)")
      ->check(not_empty("the name of a shape"))
      ->type_name("NAME");
  sub->add_option("--color", o.color, "New colour: an X11 name or #RRGGBB (default: unchanged)")->type_name("COLOR");
  sub->add_option_function<std::string>(
         "--size", [&o](const std::string& text) { o.size = read_lengths(text); }, "New size [m] (default: unchanged)")
      ->check(readable(read_lengths, "X,Y,Z above 0 and at most 1000, such as 1,0.5,0.4"))
      ->type_name("X,Y,Z");
}

void add_lane(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "lane", "Close, reverse or open a lane of a farm's road network, or let only turns leave it (not acknowledged)");
  auto& o = add_command(*sub, call, lane);
  add_examples(*sub, {"3.1 closed", "1.1 reversed --server 192.168.1.5"});
  add_farm(*sub, o);
  add_peers(*sub, o);
  sub->add_option("lane", o.lane, "Segment and number of the lane in the RNDF")->required()->type_name("SEGMENT.LANE");
  sub->add_option("use", o.use,
                  "New use: open, closed, reversed, or turn, left or right for a lane whose end only turns may leave")
      ->required()
      ->type_name("USE");
}

void add_listen(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("listen",
                                     "Receive the packets of `run --send` on every robot's ports, and count and check "
                                     "them (exit code 1 if none is valid)");
  auto& o = add_command(*sub, call, listen);
  add_examples(*sub, {"worlds/cave.world --robots 4"});
  add_world(*sub, o);
  add_json(*sub, o);
  add_robots(*sub, o);
  add_robot_from(*sub, o);
  add_ports(*sub, o);
  add_bind(*sub, o);
  add_from(*sub, o);
  add_silence(*sub, o);
  add_until(*sub, o, "Stop after this long [s] (0: at --silence or Ctrl-C)");
}

CLI::Option* add_ports_to_bind(CLI::App& app, const std::string& name, std::vector<std::uint16_t>& ports,
                               const std::string& help) {
  const auto read = [&ports](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      const std::vector<std::uint16_t> some = *read_ports(text);
      ports.insert(ports.end(), some.begin(), some.end());
    }
  };
  return app.add_option_function<std::vector<std::string>>(name, read, help)
      ->check(readable(read_ports, "a port or a range of at most 1024 such as 52000-52008"))
      ->type_name("PORT");
}

void add_dump(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("dump",
                                     "Print packets as text, one per line, from a capture file (tcpdump -w) or from "
                                     "UDP ports (exit code 1 if none is valid)");
  auto& o = add_command(*sub, call, dump, [sub] {
    if (sub->count("file") + sub->count("--port") == 0) throw CLI::RequiredError("file (or --port)");
    for (const std::string option : {"--bind", "--duration"})
      if (sub->count("file") > 0 && sub->count(option) > 0) throw CLI::ValidationError(option, "requires --port");
  });
  add_examples(*sub, {"traffic.pcap", "--port 9000 --json"});
  auto* file = sub->add_option("file", o.file, "Capture file in the classic pcap format")->type_name("FILE");
  add_ports_to_bind(*sub, "--port", o.ports, "UDP port to listen on, or a range of ports A-B (may be repeated)")
      ->excludes(file);
  add_json(*sub, o);
  add_bind(*sub, o);
  sub->add_option("--count", o.count, "Stop after this number of datagrams (0: never)")
      ->check(whole(0, 1'000'000'000'000))
      ->type_name("N");
  add_until(*sub, o, "Stop listening after this long [s] (0: at Ctrl-C)");
}

void add_map(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "map", "Show the occupancy maps that robots send, live in a terminal, and save them as pictures");
  auto& o = add_command(*sub, call, map, [sub] {
    require_any(*sub, kPageOptions, {"--out"});
    require_any(*sub, {"--interval"}, {"--out"});
    require_any(*sub, {"--map-colors"}, {"--out", "--view"});
  });
  add_examples(*sub, {"--listen 52008 -o map.png", "--listen 52008 --view"});
  add_ports_to_bind(*sub, "--listen", o.map_ports, "Port of a robot's map, or a range of ports A-B (may be repeated)")
      ->required();
  add_bind(*sub, o);
  add_from(*sub, o);
  sub->add_flag("--merge", o.merge, "Merge all maps: a cell that any robot saw occupied is occupied");
  add_picture(*sub, o.out, "Picture, replaced while maps arrive: .png, .svg or .pdf; without --merge one per map");
  sub->add_option("--interval", o.interval,
                  "Time between two pictures [s] (0: one at the end; the page: once a second)")
      ->check(number(0.0, 3600.0))
      ->type_name("S")
      ->capture_default_str();
  add_live_view(*sub, o.view, "a page with the maps as pictures");
  add_page(*sub, o);
  add_map_colors(*sub, o);
  add_until(*sub, o, "Stop after this long [s] (0: at --silence or Ctrl-C)");
  sub->add_flag("--once", o.once, "Stop when every port has received a complete map");
  add_silence(*sub, o);
  add_wire(*sub, o);
}

}  // namespace

void add_run_commands(CLI::App& app, Call& call) {
  add_run(app, call);
  add_serve(app, call);
  add_robot(app, call);
  add_light(app, call);
  add_start(app, call);
  add_object(app, call);
  add_lane(app, call);
  add_listen(app, call);
  add_dump(app, call);
  add_map(app, call);
}

}  // namespace sf::apps
