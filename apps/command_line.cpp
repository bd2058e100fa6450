#include "apps/command_line.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <map>

namespace sf::apps {

namespace {

/// "X,Y,YAW_DEG" as a pose.
base::Pose parse_pose(const std::string& text) {
  double v[3];
  int used = 0;
  const bool three = std::sscanf(text.c_str(), "%lf,%lf,%lf%n", &v[0], &v[1], &v[2], &used) == 3;
  if (!three || static_cast<std::size_t>(used) != text.size() || !std::isfinite(v[0] + v[1] + v[2]))
    throw CLI::ValidationError("--pose", "expected X,Y,YAW_DEG such as 1.5,-2,90, got '" + text + "'");
  return {v[0], v[1], 0.0, v[2] * M_PI / 180.0};
}

void add_json(CLI::App& app, Options& o) { app.add_flag("--json", o.json, "Print facts as JSON on standard output"); }

void add_device(CLI::App& app, Options& o) {
  app.add_option("--device", o.device, "Vulkan device: its row in `devices`, or part of its name")->envname("SENSORFARM_DEVICE");
}

void add_world(CLI::App& app, Options& o) {
  app.add_option("world", o.world, "World file: Stage .world (3.x or 4.x), or ROS map .yaml")->required();
  app.add_flag("--stage-obstacles", o.load.stage_obstacles, "As in Stage, floor plans with obstacle_return 0 stop nobody");
  app.add_flag("--stage-noise", o.load.stage_noise, "As in Stage, the first number of `noise` is a variance");
  app.add_flag("--unknown-is-wall", o.load.unknown_is_wall, "Unknown cells of a ROS map are walls");
}

void add_no_return(CLI::App& app, Options& o) {
  app.add_option_function<std::string>(
         "--no-return", [&o](const std::string& text) { o.no_return_inf = text == "inf"; },
         "What a beam reads that meets nothing: max (range_max) or inf (null in JSON)")
      ->check(CLI::IsMember({"max", "inf"}))
      ->default_str("max");
}

void add_ports(CLI::App& app, Options& o) {
  app.add_option("--laser-port", o.laser_port, "Base of the lasers' ports: port = base + robot id * ports per robot + sensor")
      ->check(CLI::Range(1u, 65535u))
      ->capture_default_str();
  app.add_option("--ports-per-robot", o.ports_per_robot, "Ports per robot")->check(CLI::Range(1u, 65535u))->capture_default_str();
  static const std::map<std::string, netio::Wire> kWires{{"farm", netio::Wire::farm}, {"thesis", netio::Wire::thesis}};
  app.add_option("--wire", o.wire, "Layout of sensor packets: farm (docs/packets.md) or thesis (plain)")
      ->transform(CLI::CheckedTransformer(kWires, CLI::ignore_case));
}

void add_robots(CLI::App& app, Options& o) {
  app.add_option("--robots", o.robots, "Clone the world's first robot to this many free poses")->check(CLI::Range(1u, 65535u));
  app.add_option("--seed", o.seed, "Seed of poses, wandering and noise")->capture_default_str();
}

void add_devices(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("devices", "List the Vulkan devices: chosen, or refused and why (exit 3 when none is usable)");
  add_json(*sub, o);
  add_device(*sub, o);
  sub->callback([&o] { o.command = Command::devices; });
}

void add_check(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("check", "Say what was understood of a world, and every warning with its line");
  add_world(*sub, o);
  add_json(*sub, o);
  sub->callback([&o] { o.command = Command::check; });
}

void add_draw(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("draw", "Draw the world as understood, seen from above");
  add_world(*sub, o);
  sub->add_option("-o,--out", o.out, "PNG file to write")->required();
  sub->callback([&o] { o.command = Command::draw; });
}

void add_sense(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("sense", "One reading of one sensor, noise off: check your world with a ruler");
  add_world(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_no_return(*sub, o);
  sub->add_option_function<std::string>("--pose", [&o](const std::string& text) { o.pose = parse_pose(text); },
                                        "Where the robot stands: X,Y,YAW_DEG [m, degrees]");
  sub->add_option("--robot", o.robot, "Name of the robot (default: the first)");
  sub->add_option("--sensor", o.sensor, "Number of its sensor, from 0")->capture_default_str();
  sub->callback([&o] { o.command = Command::sense; });
}

void add_run(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("run", "Simulate a fleet that wanders, with every robot's lasers, as fast as it goes");
  add_world(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_robots(*sub, o);
  add_no_return(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--duration", o.duration, "Simulated time [s]")->check(CLI::Range(0.0, 1e9))->capture_default_str();
  sub->add_option("--threads", o.threads, "Threads of the host's part (0: all); never changes a reading")->check(CLI::Range(0u, 256u));
  sub->add_option("--record", o.record, "Folder to record the run into (run.mcap)");
  sub->add_flag("--record-readings", o.record_readings, "Record the readings too, not only what they can be computed from");
  sub->add_flag("--real-time", o.real_time, "One simulated second per second");
  sub->add_option("--send", o.send, "Send every reading as UDP packets to this host");
  sub->callback([&o] { o.command = Command::run; });
}

void add_serve(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("serve", "Virtual sensors for robots that live elsewhere: V2V packets in, laser packets out");
  add_world(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_no_return(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--bind", o.bind, "Address to listen on (0.0.0.0: every interface)")->capture_default_str();
  sub->add_option("--port", o.port, "UDP port to listen on (0: any free one)")->check(CLI::Range(0u, 65535u))->capture_default_str();
  sub->add_option("--rate", o.rate, "Ticks per second (default: the world's interval_sim)")->check(CLI::Range(0.1, 10000.0));
  sub->add_option("--seed", o.seed, "Seed of noise")->capture_default_str();
  auto* duration = sub->add_option("--duration", o.duration, "Stop after this long [s] (0: when told to)")->check(CLI::Range(0.0, 1e9));
  sub->callback([&o, duration] {
    o.command = Command::serve;
    if (duration->count() == 0) o.duration = 0.0;
  });
}

void add_plot(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("plot", "Draw trajectories and an occupancy map from a recorded run");
  sub->add_option("recording", o.world, "Folder of the recording")->required();
  sub->add_option("-o,--out", o.out, "Folder for the pictures (default: the recording's own)");
  add_device(*sub, o);
  sub->callback([&o] { o.command = Command::plot; });
}

void add_listen(CLI::App& app, Options& o) {
  CLI::App* sub = app.add_subcommand("listen", "Take a run's packets on every robot's ports, count and check them");
  add_world(*sub, o);
  add_json(*sub, o);
  add_robots(*sub, o);
  add_ports(*sub, o);
  sub->add_option("--bind", o.bind, "Address to listen on")->capture_default_str();
  sub->add_option("--silence", o.silence, "End when nothing came for this long after the first packet [s]")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
  sub->callback([&o] { o.command = Command::listen; });
}

}  // namespace

Parsed parse_command_line(int argc, const char* const* argv) {
  Parsed parsed;
  CLI::App app{"sensorfarm: gives every robot of a fleet the sensors it does not have", "sensorfarm"};
  app.set_version_flag("--version", std::string("sensorfarm ") + SF_VERSION);
  app.require_subcommand(1);
  app.get_formatter()->column_width(34);
  Options& o = parsed.options;
  add_devices(app, o);
  add_check(app, o);
  add_draw(app, o);
  add_sense(app, o);
  add_run(app, o);
  add_serve(app, o);
  add_plot(app, o);
  add_listen(app, o);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // CLI11 has a code for each mistake; ours is 2 for all of them.
    parsed.exit_code = app.exit(error) == 0 ? 0 : 2;
  }
  return parsed;
}

}  // namespace sf::apps
