#include "apps/option_groups.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>

#include "apps/option_parsers.h"
#include "control/controllers.h"
#include "sensors/accuracy.h"

namespace sf::apps {

Validator whole(std::uint64_t first, std::uint64_t last) {
  return [first, last](const std::string& text) { return check_integer(text, first, last); };
}

Validator number(double first, double last) {
  return [first, last](const std::string& text) { return check_number(text, first, last); };
}

Validator one_of(std::vector<std::string> words) {
  return [words = std::move(words)](const std::string& text) { return check_choice(text, words); };
}

Validator not_empty(std::string what) {
  return [what = std::move(what)](const std::string& text) { return check_not_empty(text, what); };
}

Validator picture() {
  return [](const std::string& text) {
    const std::filesystem::path file(text);
    const std::string suffix = file.extension().string();
    if (text.empty() || suffix.empty() || suffix == ".png" || suffix == ".PNG") return check_not_empty(text, "a file");
    return fmt::format("pictures are PNG files, and '{}' ends in {}; write {}", text, suffix,
                       std::filesystem::path(file).replace_extension(".png").string());
  };
}

namespace {

/// @param fine whether it is what was expected
Validator expected(const char* what, bool (*fine)(const std::string&)) {
  return [what, fine](const std::string& text) {
    return fine(text) ? std::string() : fmt::format("expected {}, got '{}'", what, text);
  };
}

}  // namespace

Validator key_and_value() {
  return expected("KEY=VALUE such as kp=0.5", [](const std::string& text) {
    const std::size_t at = text.find('=');
    return at != std::string::npos && at > 0;
  });
}

Validator pose() {
  return expected("X,Y,YAW_DEG such as 1.5,-2,90", [](const std::string& text) { return read_pose(text).has_value(); });
}

Validator line() {
  return expected("X0,Y0,X1,Y1 of two points such as -1,0,2,0.5",
                  [](const std::string& text) { return read_line(text).has_value(); });
}

Validator extent() {
  return expected("XMIN,YMIN,XMAX,YMAX such as -1,-1,2,1", [](const std::string& text) {
    const auto e = read_line(text);
    return e && (*e)[0] < (*e)[2] && (*e)[1] < (*e)[3];
  });
}

Validator ports() {
  return expected("a port or a range of at most 1024 such as 52000-52008",
                  [](const std::string& text) { return !read_ports(text).empty(); });
}

Validator quantity() {
  return expected("a length or a field with its unit such as 5mm, 0.01m, 2uT or 1mG",
                  [](const std::string& text) { return read_quantity(text).has_value(); });
}

Validator rate() {
  return expected("a rate above zero such as 10Hz",
                  [](const std::string& text) { return read_rate(text).has_value(); });
}

void on_parsed(CLI::App& sub, std::function<void()> set, std::function<void()> check) {
  sub.callback([set = std::move(set), check = std::move(check)] {
    if (check) check();
    set();
  });
}

void add_json(CLI::App& app, JsonOption& o) {
  app.add_flag("--json", o.json, "Print facts as JSON on standard output");
}

void add_device(CLI::App& app, DeviceOption& o) {
  if (const char* device = std::getenv("SENSORFARM_DEVICE")) o.device = device;
  app.add_option("--device", o.device,
                 "Vulkan device: its row in `devices`, or part of its name (else $SENSORFARM_DEVICE, else the best)")
      ->type_name("NAME");
  // Farms look it up where they are made (raycast/caster_choice.h).
  app.add_option_function<std::string>(
         "--caster", [](const std::string& word) { setenv("SENSORFARM_CASTER", word.c_str(), 1); },
         "Casts rays by the device's kernels or the host's vectors, to the same bytes (else $SENSORFARM_CASTER, "
         "else auto: host where the device is software)")
      ->type_name("auto|vulkan|host")
      ->check(CLI::IsMember({"auto", "vulkan", "host"}));
}

void add_world(CLI::App& app, WorldOptions& o) {
  o.load.sensors = sensors::world_file_words();
  app.add_option("world", o.world,
                 "World file: Stage .world (3.x or 4.x), or ROS map .yaml; check and draw also take .rndf, check .mdf")
      ->required()
      ->type_name("FILE");
  app.add_flag("--stage-obstacles", o.load.stage_obstacles,
               "As in Stage, floor plans with obstacle_return 0 stop nobody");
  app.add_flag("--stage-noise", o.load.stage_noise, "As in Stage, the first number of `noise` is a variance");
  app.add_flag("--unknown-is-wall", o.load.unknown_is_wall, "Unknown cells of a ROS map are walls");
  app.add_flag("--strict", o.load.strict_roads,
               "Refuse road networks and missions at the first slip, even where its meaning is clear");
}

void add_accuracy(CLI::App& app, WorldOptions& o) {
  std::vector<std::string> words;
  for (const std::string_view word : sensors::accuracy_words()) words.emplace_back(word);
  app.add_option("--accuracy", o.load.accuracy,
                 "Accuracy of all sensors, whatever the world says: " + join_or(words) +
                     "; several for several kinds, as in \"laser:skip2 near3\" (docs/accuracy.md)")
      ->check(not_empty("a word"))
      ->type_name("WORDS");
}

void add_accuracy_target(CLI::App& app, AccuracyTargetOptions& o) {
  app.add_option_function<std::vector<std::string>>(
         "--max-error",
         [&o](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) {
             const Quantity q = *read_quantity(text);
             (q.is_tesla ? o.accuracy_target.tesla : o.accuracy_target.metres) = q.value;
           }
         },
         "Largest error wanted, with its unit: 5mm for what measures lengths, 2uT for fields (may be given for both)")
      ->check(quantity())
      ->allow_extra_args(false)
      ->type_name("ERROR");
  app.add_option_function<std::string>(
         "--by",
         [&o](const std::string& text) {
           o.accuracy_target.by = text == "median" ? scenarios::ErrorMeasure::median
                                  : text == "p99"  ? scenarios::ErrorMeasure::p99
                                                   : scenarios::ErrorMeasure::max;
         },
         "Which error is meant: the largest, that of 99 % of all readings, or the median")
      ->check(one_of({"max", "p99", "median"}))
      ->type_name("max|p99|median")
      ->default_str("max");
  app.add_option_function<std::string>(
         "--min-rate", [&o](const std::string& text) { o.accuracy_target.least_rate = *read_rate(text); },
         "Ticks per second wanted: the most accurate modes that allow it")
      ->check(rate())
      ->type_name("HZ");
}

void add_automatic(CLI::App& app, AccuracyTargetOptions& o) {
  add_accuracy_target(app, o);
  auto* automatic = app.add_flag(
      "--auto", o.automatic, "Measure the modes here first, and take those that --max-error or --min-rate comes to");
  for (const char* wish : {"--max-error", "--min-rate", "--by"}) app.get_option(wish)->needs(automatic);
  app.get_option("--accuracy")->excludes(automatic);
}

void add_no_return(CLI::App& app, NoReturnOption& o) {
  app.add_option_function<std::string>(
         "--no-return", [&o](const std::string& text) { o.no_return_inf = text == "inf"; },
         "What a beam reads that meets nothing: max (range_max) or inf (null in JSON)")
      ->check(one_of({"max", "inf"}))
      ->type_name("max|inf")
      ->default_str("max");
}

void add_wire(CLI::App& app, WireOption& o) {
  app.add_option_function<std::string>(
         "--wire",
         [&o](const std::string& text) {
           o.wire = text == "thesis" ? sensors::WireFormat::thesis : sensors::WireFormat::farm;
         },
         "Layout of sensor packets: farm (docs/packets.md) or thesis (plain)")
      ->check(one_of({"farm", "thesis"}))
      ->type_name("farm|thesis")
      ->default_str("farm");
}

void add_bind(CLI::App& app, BindOption& o) {
  app.add_option("--bind", o.bind, "Address to listen on (0.0.0.0: every interface)")
      ->check(not_empty("an address"))
      ->type_name("ADDR")
      ->capture_default_str();
}

void add_from(CLI::App& app, ReceiveOptions& o) {
  app.add_option("--from", o.from, "Take packets from this host alone (default: from the first farm that sends)")
      ->check(not_empty("a host"))
      ->type_name("HOST");
}

void add_silence(CLI::App& app, ReceiveOptions& o) {
  app.add_option("--silence", o.silence,
                 "End when nothing came for this long [s]; counts from the first packet on, until then it waits")
      ->check(number(0.1, 1e6))
      ->type_name("S")
      ->capture_default_str();
}

void add_until(CLI::App& app, DurationOption& o, const std::string& help) {
  app.add_option("--duration", o.duration, help)->check(number(0.0, 1e9))->type_name("S");
}

void add_ports(CLI::App& app, PortOptions& o) {
  constexpr const char* kPorts = "Ports of sensor packets: first + robot id * ports per robot + sensor";
  for (const sensors::SensorType* kind : sensors::sensor_types()) {
    o.base_ports[kind->id] = kind->base_port;
    app.add_option(fmt::format("--{}-port", kind->name), o.base_ports[kind->id],
                   fmt::format("First of the {} ports", kind->name))
        ->check(whole(1, 65535))
        ->type_name("PORT")
        ->capture_default_str()
        ->group(kPorts);
  }
  app.add_option("--ports-per-robot", o.ports_per_robot, "Ports per robot (default: 8, or the least that fits)")
      ->check(whole(1, 65535))
      ->type_name("N")
      ->group(kPorts);
  add_wire(app, o);
}

void add_threads(CLI::App& app, ThreadsOption& o) {
  app.add_option("--threads", o.threads, "Threads of the host's part (0: all); never changes a reading")
      ->check(whole(0, 256))
      ->type_name("N");
}

void add_recording(CLI::App& app, RecordingOption& o) {
  app.add_option("recording", o.recording, "Folder of the recording")->required()->type_name("DIR");
}

void add_kind(CLI::App& app, SenseOptions& o) {
  std::vector<std::string> names;
  for (const sensors::SensorType* kind : sensors::sensor_types()) names.emplace_back(kind->name);
  app.add_option_function<std::string>(
         "--kind",
         [&o](const std::string& text) {
           for (const sensors::SensorType* kind : sensors::sensor_types())
             if (kind->name == text) o.kind = kind->id;
         },
         "Kind of its sensor: " + join_or(names) + " (default: the first that it has)")
      ->check(one_of(names))
      ->type_name("KIND");
}

void add_seed(CLI::App& app, SeedOption& o, const std::string& what) {
  app.add_option("--seed", o.seed, what)->check(whole(0, UINT64_MAX))->type_name("K")->capture_default_str();
}

void add_robots(CLI::App& app, CloneOptions& o) {
  auto* robots = app.add_option("--robots", o.robots, "Clone one robot of the world to this many free poses")
                     ->check(whole(1, 65535))
                     ->type_name("N");
  app.add_option("--of", o.of, "The robot that is cloned (default: the first with sensors)")
      ->check(not_empty("the name of a robot"))
      ->needs(robots)
      ->type_name("NAME");
  add_seed(app, o, "Seed of poses, decisions and noise");
}

void add_controller(CLI::App& app, ControllerOptions& o) {
  std::vector<std::string> names;
  for (const control::ControllerType* kind : control::controllers()) names.emplace_back(kind->name);
  app.add_option("--controller", o.controller, "Who drives: " + join_or(names))
      ->check(one_of(names))
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--set", o.set,
                 "One of the controller's settings (may be repeated): kp=0.5, park=13.4, checkpoints=1,2 or \"[1 2]\"")
      ->check(key_and_value())
      ->type_name("KEY=VALUE");
}

}  // namespace sf::apps
