#include "apps/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "apps/wording.h"
#include "control/controllers.h"
#include "scenarios/experiment.h"

namespace sf::apps {

namespace {

CLI::Validator whole(std::uint64_t first, std::uint64_t last) {
  return {[first, last](std::string& text) { return refuse_whole(text, first, last); }, ""};
}

CLI::Validator number(double first, double last) {
  return {[first, last](std::string& text) { return refuse_number(text, first, last); }, ""};
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  return {[words](std::string& text) { return refuse_choice(text, words); }, ""};
}

CLI::Validator not_empty(const std::string& what) {
  return {[what](std::string& text) { return refuse_empty(text, what); }, ""};
}

CLI::Validator key_and_value() {
  return {[](std::string& text) {
            const std::size_t at = text.find('=');
            return at == std::string::npos || at == 0 ? fmt::format("expected KEY=VALUE such as kp=0.5, got '{}'", text)
                                                      : "";
          },
          ""};
}

CLI::Validator pose() {
  return {[](std::string& text) {
            return read_pose(text) ? "" : fmt::format("expected X,Y,YAW_DEG such as 1.5,-2,90, got '{}'", text);
          },
          ""};
}

CLI::Validator line() {
  return {[](std::string& text) {
            return read_line(text)
                       ? ""
                       : fmt::format("expected X0,Y0,X1,Y1 of two points such as -1,0,2,0.5, got '{}'", text);
          },
          ""};
}

CLI::Validator extent() {
  return {[](std::string& text) {
            const auto e = read_line(text);
            const bool fine = e && (*e)[0] < (*e)[2] && (*e)[1] < (*e)[3];
            return fine ? "" : fmt::format("expected XMIN,YMIN,XMAX,YMAX such as -1,-1,2,1, got '{}'", text);
          },
          ""};
}

CLI::Validator ports() {
  return {[](std::string& text) {
            return read_ports(text).empty() ? fmt::format(
                                                  "expected a port or a range of at most 1024 such as "
                                                  "52000-52008, got '{}'",
                                                  text)
                                            : "";
          },
          ""};
}

void add_json(CLI::App& app, Options& o) { app.add_flag("--json", o.json, "Print facts as JSON on standard output"); }

/// CLI11's own envname would set what all subcommands share after the one that was called has set it.
void add_device(CLI::App& app, Options& o) {
  app.add_option("--device", o.device,
                 "Vulkan device: its row in `devices`, or part of its name (else $SENSORFARM_DEVICE, else the best)")
      ->type_name("NAME");
}

void add_world(CLI::App& app, Options& o) {
  app.add_option("world", o.world,
                 "World file: Stage .world (3.x or 4.x), or ROS map .yaml; check and draw also take .rndf, check .mdf")
      ->required()
      ->type_name("FILE");
  app.add_flag("--stage-obstacles", o.load.stage_obstacles,
               "As in Stage, floor plans with obstacle_return 0 stop nobody");
  app.add_flag("--stage-noise", o.load.stage_noise, "As in Stage, the first number of `noise` is a variance");
  app.add_flag("--unknown-is-wall", o.load.unknown_is_wall, "Unknown cells of a ROS map are walls");
}

void add_no_return(CLI::App& app, Options& o) {
  app.add_option_function<std::string>(
         "--no-return", [&o](const std::string& text) { o.no_return_inf = text == "inf"; },
         "What a beam reads that meets nothing: max (range_max) or inf (null in JSON)")
      ->check(one_of({"max", "inf"}))
      ->type_name("max|inf")
      ->default_str("max");
}

void add_wire(CLI::App& app, Options& o) {
  app.add_option_function<std::string>(
         "--wire",
         [&o](const std::string& text) { o.wire = text == "thesis" ? sensors::Wire::thesis : sensors::Wire::farm; },
         "Layout of sensor packets: farm (docs/packets.md) or thesis (plain)")
      ->check(one_of({"farm", "thesis"}))
      ->type_name("farm|thesis")
      ->default_str("farm");
}

void add_ports(CLI::App& app, Options& o) {
  for (const sensors::SensorKind* kind : sensors::kinds())
    app.add_option(fmt::format("--{}-port", kind->name), o.base_ports[kind->id],
                   fmt::format("Base of {} ports: port = base + robot id * ports per robot + sensor", kind->name))
        ->check(whole(1, 65535))
        ->type_name("PORT")
        ->capture_default_str();
  app.add_option("--ports-per-robot", o.ports_per_robot, "Ports per robot")
      ->check(whole(1, 65535))
      ->type_name("N")
      ->capture_default_str();
  add_wire(app, o);
}

void add_kind(CLI::App& app, Options& o) {
  std::vector<std::string> names;
  for (const sensors::SensorKind* kind : sensors::kinds()) names.emplace_back(kind->name);
  app.add_option_function<std::string>(
         "--kind",
         [&o](const std::string& text) {
           for (const sensors::SensorKind* kind : sensors::kinds())
             if (kind->name == text) o.kind = kind->id;
         },
         "Kind of its sensor: " + either(names) + " (default: the first that it has)")
      ->check(one_of(names))
      ->type_name("KIND");
}

void add_seed(CLI::App& app, Options& o, const std::string& what) {
  app.add_option("--seed", o.seed, what)->check(whole(0, UINT64_MAX))->type_name("K")->capture_default_str();
}

void add_robots(CLI::App& app, Options& o) {
  app.add_option("--robots", o.robots, "Clone the world's first robot to this many free poses")
      ->check(whole(1, 65535))
      ->type_name("N");
  add_seed(app, o, "Seed of poses, decisions and noise");
}

void add_controller(CLI::App& app, Options& o) {
  std::vector<std::string> names;
  for (const control::ControllerKind* kind : control::controllers()) names.emplace_back(kind->name);
  app.add_option("--controller", o.controller, "Who drives: " + either(names))
      ->check(one_of(names))
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--set", o.set,
                 "One of the controller's settings (may be repeated): kp=0.5, park=13.4, checkpoints=1,2 or \"[1 2]\"")
      ->check(key_and_value())
      ->type_name("KEY=VALUE");
}

void add_devices(CLI::App& app, Options& o) {
  CLI::App* sub =
      app.add_subcommand("devices", "List the Vulkan devices: chosen, or refused and why (exit 3 when none is usable)");
  add_json(*sub, o);
  add_device(*sub, o);
  sub->callback([&o] { o.command = Command::devices; });
}

void add_check(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("check", "Say what was understood of a world, and every warning with its line");
  add_world(*sub, o);
  sub->add_option("--rndf", o.rndf, "Road network that a mission (.mdf) is checked against")
      ->check(not_empty("a file"))
      ->type_name("FILE");
  add_json(*sub, o);
  sub->callback([&o] { o.command = Command::check; });
}

void add_draw(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("draw", "Draw the world as understood, seen from above");
  add_world(*sub, o);
  sub->add_option("-o,--out", o.out, "PNG file to write")->required()->check(not_empty("a file"))->type_name("FILE");
  sub->callback([&o] { o.command = Command::draw; });
}

void add_field(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("field", "Draw the field of a world's magnets at one height, and along a line");
  add_world(*sub, o);
  add_device(*sub, o);
  sub->add_option("--height", o.height, "Height in the world [m]")
      ->required()
      ->check(number(-1e6, 1e6))
      ->type_name("Z");
  sub->add_option("-o,--out", o.out, "PNG file to write")->required()->check(not_empty("a file"))->type_name("FILE");
  sub->add_option_function<std::string>(
         "--line", [&o](const std::string& text) { o.line = read_line(text); },
         "Ends of the profile's line [m] (default: along the magnets)")
      ->check(line())
      ->type_name("X0,Y0,X1,Y1");
  sub->add_option_function<std::string>(
         "--extent", [&o](const std::string& text) { o.extent = read_line(text); },
         "What the map must show [m] (default: all magnets)")
      ->check(extent())
      ->type_name("X0,Y0,X1,Y1");
  sub->add_option("--csv", o.csv, "File to write the profile's numbers to")
      ->check(not_empty("a file"))
      ->type_name("FILE");
  sub->callback([&o] { o.command = Command::field; });
}

void add_sense(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("sense", "One reading of one sensor, noise off: check your world with a ruler");
  add_world(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_no_return(*sub, o);
  sub->add_option_function<std::string>(
         "--pose", [&o](const std::string& text) { o.pose = read_pose(text); },
         "Where the robot stands: X,Y,YAW_DEG [m, degrees]")
      ->check(pose())
      ->type_name("POSE");
  sub->add_option("--robot", o.robot, "Name of the robot (default: the first that has a sensor)")->type_name("NAME");
  add_kind(*sub, o);
  sub->add_option("--sensor", o.sensor,
                  "Number of its sensor, from 0: of that kind, or through all its kinds where none is named")
      ->check(whole(0, 65535))
      ->type_name("N")
      ->capture_default_str();
  sub->callback([&o] { o.command = Command::sense; });
}

void add_run(CLI::App& app, Options& o) {
  CLI::App* sub =
      app.add_subcommand("run", "Simulate a fleet in the loop, with every robot's sensors, as fast as it goes");
  add_world(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_robots(*sub, o);
  add_controller(*sub, o);
  add_no_return(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--duration", o.duration, "Simulated time [s]")
      ->check(number(0.0, 1e9))
      ->type_name("S")
      ->capture_default_str();
  sub->add_option("--threads", o.threads, "Threads of the host's part (0: all); never changes a reading")
      ->check(whole(0, 256))
      ->type_name("N");
  auto* record = sub->add_option("--record", o.record, "Folder to record the run into (run.mcap)")
                     ->check(not_empty("a folder"))
                     ->type_name("DIR");
  sub->add_flag("--record-readings", o.record_readings,
                "Record the readings too, not only what they can be computed from")
      ->needs(record);
  sub->add_flag("--real-time", o.real_time, "One simulated second per second");
  sub->add_option("--send", o.send, "Send every reading as UDP packets to this host")
      ->check(not_empty("a host"))
      ->type_name("HOST");
  sub->callback([&o] { o.command = Command::run; });
}

void add_serve(CLI::App& app, Options& o) {
  CLI::App* sub =
      app.add_subcommand("serve", "Virtual sensors for robots that live elsewhere: V2V packets in, sensor packets out");
  add_world(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_no_return(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--bind", o.bind, "Address to listen on (0.0.0.0: every interface)")
      ->check(not_empty("an address"))
      ->type_name("ADDR")
      ->capture_default_str();
  sub->add_option("--port", o.port, "UDP port to listen on (0: any free one)")
      ->check(whole(0, 65535))
      ->type_name("PORT")
      ->capture_default_str();
  sub->add_option("--rate", o.rate, "Ticks per second (default: the world's interval_sim)")
      ->check(number(0.1, 10000.0))
      ->type_name("HZ");
  add_seed(*sub, o, "Seed of noise");
  auto* duration = sub->add_option("--duration", o.duration, "Stop after this long [s] (0: when told to)")
                       ->check(number(0.0, 1e9))
                       ->type_name("S");
  sub->callback([&o, duration] {
    o.command = Command::serve;
    if (duration->count() == 0) o.duration = 0.0;
  });
}

void add_farm(CLI::App& app, Options& o) {
  app.add_option("--server", o.server, "Host of the farm that serves")
      ->check(not_empty("a host"))
      ->type_name("HOST")
      ->capture_default_str();
  app.add_option("--port", o.port, "UDP port that it listens on")
      ->check(whole(1, 65535))
      ->type_name("PORT")
      ->capture_default_str();
}

void add_link(CLI::App& app, Options& o) {
  app.add_option("--delay", o.delay, "Injected delay of every packet, in each direction [s]")
      ->check(number(0.0, 3600.0))
      ->type_name("S");
  app.add_option("--jitter", o.jitter, "More delay, evenly from 0 to this; packets overtake each other [s]")
      ->check(number(0.0, 3600.0))
      ->type_name("S");
  app.add_option("--loss", o.loss, "Part of the packets that never come, in each direction, 0 to 1")
      ->check(number(0.0, 1.0))
      ->type_name("P");
}

void add_robot(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand(
      "robot",
      "One simulated robot, a process of its own beside a farm that serves (exit 1 when nothing came from it)");
  add_world(*sub, o);
  add_json(*sub, o);
  add_controller(*sub, o);
  add_farm(*sub, o);
  add_link(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--name", o.robot, "Name of the robot in the world")->required()->type_name("NAME");
  sub->add_option("--rate", o.rate, "Decisions, and packets, per second (default: the controller's own)")
      ->check(number(0.1, 1000.0))
      ->type_name("HZ");
  sub->add_flag("--wait-for-start", o.wait_for_start, "Stand until the start signal comes (`sensorfarm start`)");
  add_seed(*sub, o, "Seed of decisions and of the injected link");
  auto* duration = sub->add_option("--duration", o.duration, "Stop after this long [s] (0: when done or told to)")
                       ->check(number(0.0, 1e9))
                       ->type_name("S");
  sub->callback([&o, duration] {
    o.command = Command::robot;
    if (duration->count() == 0) o.duration = 0.0;
  });
}

void add_start(CLI::App& app, Options& o) {
  CLI::App* sub =
      app.add_subcommand("start", "Give robots that wait for it the start signal, through the farm (not acknowledged)");
  add_farm(*sub, o);
  sub->add_option("--robot", o.start_id, "Id of the robot (default: all)")->check(whole(0, 65535))->type_name("ID");
  sub->callback([&o] { o.command = Command::start; });
}

void add_plot(CLI::App& app, Options& o) {
  CLI::App* sub =
      app.add_subcommand("plot", "Draw trajectories, an occupancy map and recorded readings from a recorded run");
  sub->add_option("recording", o.world, "Folder of the recording")->required()->type_name("DIR");
  sub->add_option("-o,--out", o.out, "Folder for the pictures (default: the recording's own)")
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  add_device(*sub, o);
  sub->callback([&o] { o.command = Command::plot; });
}

void add_listen(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand(
      "listen", "Take a run's packets on every robot's ports, count and check them (exit 1 when none was good)");
  add_world(*sub, o);
  add_json(*sub, o);
  add_robots(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--bind", o.bind, "Address to listen on")
      ->check(not_empty("an address"))
      ->type_name("ADDR")
      ->capture_default_str();
  sub->add_option("--silence", o.silence,
                  "End when nothing came for this long [s]; counts from the first packet on, until then it waits")
      ->check(number(0.1, 1e6))
      ->type_name("S")
      ->capture_default_str();
  auto* duration = sub->add_option("--duration", o.duration, "Stop after this long [s] (0: when told to, or silent)")
                       ->check(number(0.0, 1e9))
                       ->type_name("S");
  sub->callback([&o, duration] {
    o.command = Command::listen;
    if (duration->count() == 0) o.duration = 0.0;
  });
}

void add_experiment(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand(
      "experiment", "Run one of the experiments: trials, statistics beside the thesis', figures, in one folder");
  auto* list = sub->add_flag("--list", o.list, "Name them all");
  std::vector<std::string> names;
  for (const scenarios::ExperimentKind* kind : scenarios::experiments()) names.emplace_back(kind->name);
  auto* name = sub->add_option("experiment", o.experiment, either(names))->check(one_of(names))->type_name("NAME");
  auto* out =
      sub->add_option("-o,--out", o.out, "Folder to write into")->check(not_empty("a folder"))->type_name("DIR");
  name->needs(out)->excludes(list);
  sub->add_option("--trials", o.trials, "How many, each with a seed of its own")
      ->check(whole(1, 1000))
      ->type_name("N")
      ->capture_default_str();
  add_seed(*sub, o, "Seed of the first trial");
  sub->add_option_function<std::string>(
         "--plant", [&o](const std::string& text) { o.plant = scenarios::plant_of(text); },
         "What stands between commands and wheels: ideal (nothing) or thesis (Player's driver for the Create). "
         "Default: "
         "thesis for what it did with its Creates (paths, sweeps, mapping); ideal for towns and Pioneers")
      ->check(one_of({"thesis", "ideal"}))
      ->type_name("thesis|ideal");
  sub->add_option("--files", o.experiments, "Folder with the experiments' scenario files (default: ours)")
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  add_device(*sub, o);
  sub->callback([&o, list, name] {
    o.command = Command::experiment;
    if (list->count() + name->count() == 0) throw CLI::RequiredError("the name of an experiment, or --list");
  });
}

void add_test(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("test", "Run scenarios and hold them to what they expect (exit 1 when one fails)");
  sub->add_option("scenario", o.scenarios, "Scenario files (.toml)")->required()->type_name("FILE");
  sub->add_option("--junit", o.junit, "Write the results as JUnit XML")->check(not_empty("a file"))->type_name("FILE");
  add_device(*sub, o);
  sub->callback([&o] { o.command = Command::test; });
}

void add_map(CLI::App& app, Options& o) {
  CLI::App* sub =
      app.add_subcommand("map", "Show the occupancy maps that robots send, live in a terminal, and draw them");
  sub->add_option_function<std::vector<std::string>>(
         "--listen",
         [&o](const std::vector<std::string>& texts) {
           for (const std::string& text : texts)
             for (const std::uint16_t port : read_ports(text)) o.map_ports.push_back(port);
         },
         "Port of a robot's map, or a range of ports A-B; may be given more than once")
      ->required()
      ->check(ports())
      ->type_name("PORT");
  sub->add_option("--bind", o.bind, "Address to listen on (0.0.0.0: every interface)")
      ->check(not_empty("an address"))
      ->type_name("HOST")
      ->capture_default_str();
  sub->add_flag("--merge", o.merge, "All maps as one: what any robot saw occupied is occupied");
  sub->add_option("-o,--out", o.out, "PNG file to write at the end; of several maps that are not merged, one each")
      ->check(not_empty("a file"))
      ->type_name("FILE");
  auto* duration = sub->add_option("--duration", o.duration, "Stop after this long [s] (0: when told to, or silent)")
                       ->check(number(0.0, 1e9))
                       ->type_name("S");
  sub->add_flag("--once", o.once, "Stop when every port has brought a whole map");
  sub->add_option("--silence", o.silence, "End when nothing came for this long after the first packet [s]")
      ->check(number(0.1, 1e6))
      ->type_name("S")
      ->capture_default_str();
  add_wire(*sub, o);
  sub->callback([&o, duration] {
    o.command = Command::map;
    if (duration->count() == 0) o.duration = 0.0;
  });
}

std::string names_of(const std::vector<const CLI::App*>& subcommands) {
  std::string names;
  for (const CLI::App* sub : subcommands) names += (names.empty() ? "" : ", ") + sub->get_name();
  return names;
}

std::vector<std::string> options_of(const CLI::App& sub) {
  std::vector<std::string> names;
  for (const CLI::Option* option : sub.get_options())
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  return names;
}

/// The first argument that nobody wanted; CLI11 names all, from the last on.
std::string explain_extras(const CLI::App& app, const CLI::App& sub, int argc, const char* const* argv) {
  const std::vector<std::string> rest = app.remaining(true);
  const auto* const found =
      std::find_if(argv + 1, argv + argc, [&](const char* a) { return std::count(rest.begin(), rest.end(), a) > 0; });
  const std::string word = found == argv + argc ? "" : *found;
  return fmt::format("'{}' was not expected{}", word, suggest_option(word, options_of(sub)));
}

/// What was wrong with the arguments, in one line that ends with where help is.
std::string explain(const CLI::App& app, const CLI::ParseError& error, int argc, const char* const* argv) {
  const std::vector<CLI::App*> used = app.get_subcommands();
  if (used.empty()) {
    const std::string all = names_of(app.get_subcommands([](const CLI::App*) { return true; }));
    const std::string what = argc > 1 ? fmt::format("'{}' is no subcommand; expected one of {}", argv[1], all)
                                      : fmt::format("expected a subcommand: {}", all);
    return what + "; see `sensorfarm --help`";
  }
  std::string what = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) what = explain_extras(app, *used[0], argc, argv);
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr)
    what = what.substr(0, what.find(':')) + " needs a value after it";
  return fmt::format("{}; see `sensorfarm {} --help`", what, used[0]->get_name());
}

}  // namespace

Parsed parse_command_line(int argc, const char* const* argv) {
  Parsed parsed;
  CLI::App app{"sensorfarm: gives every robot of a fleet the sensors it does not have", "sensorfarm"};
  app.set_version_flag("--version", std::string("sensorfarm ") + SF_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  Options& o = parsed.options;
  if (const char* device = std::getenv("SENSORFARM_DEVICE")) o.device = device;
  o.load.sensors = sensors::vocabulary();
  for (const sensors::SensorKind* kind : sensors::kinds()) o.base_ports[kind->id] = kind->base_port;
  add_devices(app, o);
  add_check(app, o);
  add_draw(app, o);
  add_field(app, o);
  add_sense(app, o);
  add_run(app, o);
  add_serve(app, o);
  add_robot(app, o);
  add_start(app, o);
  add_plot(app, o);
  add_listen(app, o);
  add_experiment(app, o);
  add_test(app, o);
  add_map(app, o);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 has a code for each mistake; ours is 2 for all of them.
    const bool fine = error.get_exit_code() == 0;
    if (fine) app.exit(error);
    if (!fine) std::fprintf(stderr, "sensorfarm: %s\n", explain(app, error, argc, argv).c_str());
    parsed.exit_code = fine ? 0 : 2;
  }
  return parsed;
}

}  // namespace sf::apps
