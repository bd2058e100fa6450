#include "apps/options/option_groups.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <tuple>

#include "apps/options/option_parsers.h"
#include "apps/reports/text.h"
#include "base/installation.h"
#include "bridges/dds.h"
#include "control/own_controllers.h"
#include "raycast/casters.h"
#include "sensors/accuracy.h"

namespace sf::apps {

namespace {

// Headings in the help.
constexpr const char* kWorld = "World file";
constexpr const char* kAccuracy = "Accuracy";
constexpr const char* kDevice = "Device";
constexpr const char* kNaming = "Names of topics and frames (docs/bridges.md)";
constexpr const char* kPorts = "Ports of sensor packets (first + robot id * ports per robot + sensor)";

}  // namespace

void on_parsed(CLI::App& sub, std::function<void()> set, std::function<void()> check) {
  sub.callback([set = std::move(set), check = std::move(check)] {
    if (check) check();
    set();
  });
}

void add_examples(CLI::App& sub, const std::vector<std::string>& arguments) {
  std::string text = "Examples:";
  for (const std::string& each : arguments) text += fmt::format("\n  sensorfarm {} {}", sub.get_name(), each);
  sub.footer(text);
}

CLI::Option* add_choice(CLI::App& app, const std::string& name, const std::vector<std::string>& words,
                        const std::function<void(const std::string&)>& set, const std::string& help) {
  return app.add_option_function<std::string>(name, set, help)
      ->check(one_of(words))
      ->type_name(fmt::format("{}", fmt::join(words, "|")));
}

void add_json(CLI::App& app, JsonOption& o) {
  app.add_flag("--json", o.json, "Print the report as JSON on standard output");
}

namespace {

std::string caster_help() {
  std::vector<std::string> casters;
  for (const raycast::CasterType* type : raycast::casters())
    casters.push_back(fmt::format("{}: {}", type->name, type->summary));
  return fmt::format(
      "Ray caster. {} (default: $SENSORFARM_CASTER, or auto: host if the device is software, otherwise vulkan)",
      fmt::join(casters, "; "));
}

}  // namespace

void add_device(CLI::App& app, DeviceOption& o) {
  app.add_option("--device", o.device,
                 "Vulkan device, by its row in `devices` or part of its name, or host: no device, with the same "
                 "results (default: the best device, or the host if there is none)")
      ->envname("SENSORFARM_DEVICE")
      ->type_name("NAME")
      ->group(kDevice);
  app.add_flag("--require-vulkan", o.require_vulkan,
               "Exit with code 3 if no Vulkan device is usable, instead of computing on the host (also "
               "SENSORFARM_REQUIRE_VULKAN=1)")
      ->group(kDevice);
  // Read where farms are created (raycast/casters.h).
  add_choice(
      app, "--caster", raycast::caster_words(),
      [](const std::string& word) { setenv("SENSORFARM_CASTER", word.c_str(), 1); }, caster_help())
      ->group(kDevice);
}

void add_world(CLI::App& app, WorldOptions& o) {
  o.load.sensors = sensors::world_file_words();
  o.load.controllers = control::controller_names;
  o.load.model_controllers = control::model_controller_names;
  app.add_option(
         "world", o.world,
         "World file: Stage .world (3.x or 4.x) or ROS map .yaml; check and draw also accept .rndf, and check .mdf")
      ->required()
      ->transform(base::installed_file)
      ->type_name("FILE");
  app.add_flag("--stage-obstacles", o.load.stage_obstacles,
               "As in Stage, floor plans with obstacle_return 0 do not stop robots")
      ->group(kWorld);
  app.add_flag("--stage-noise", o.load.stage_noise, "As in Stage, the first number of `noise` is a variance")
      ->group(kWorld);
  app.add_flag("--unknown-is-wall", o.load.unknown_is_wall, "Treat unknown cells of a ROS map as walls")->group(kWorld);
  app.add_flag("--strict", o.load.strict,
               "Reject road networks and missions with any error, even if the meaning is clear, and outline files with "
               "any row that has no walls or no valid height")
      ->group(kWorld);
}

CLI::Option* add_accuracy(CLI::App& app, std::string& words, const std::string& help) {
  std::vector<std::string> known;
  for (const std::string_view word : sensors::accuracy_words()) known.emplace_back(word);
  return app
      .add_option("--accuracy", words,
                  help + ": " + join_or(known) +
                      "; combine several for different types, as in \"laser:skip2 near3\" (docs/accuracy.md)")
      ->check(not_empty("a word"))
      ->type_name("WORDS");
}

void add_accuracy(CLI::App& app, WorldOptions& o) {
  add_accuracy(app, o.load.accuracy, "Accuracy mode of all sensors, overriding the world's")->group(kAccuracy);
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
         "Largest error allowed, with its unit: 5mm for lengths, 2uT for magnetic fields (both may be given)")
      ->check(readable(read_quantity, "a length or a field with its unit such as 5mm, 0.01m, 2uT or 1mG"))
      ->allow_extra_args(false)
      ->type_name("ERROR")
      ->group(kAccuracy);
  using scenarios::ErrorMeasure;
  add_choice<ErrorMeasure, ErrorMeasure>(
      app, "--by", o.accuracy_target.by,
      {{"max", ErrorMeasure::max}, {"p99", ErrorMeasure::p99}, {"median", ErrorMeasure::median}},
      "Error statistic that --max-error limits: the largest, the 99th percentile or the median")
      ->default_str("max")
      ->group(kAccuracy);
  app.add_option_function<std::string>(
         "--min-rate", [&o](const std::string& text) { o.accuracy_target.least_rate = *read_rate(text); },
         "Ticks per second to reach; selects the most accurate modes that reach it")
      ->check(readable(read_rate, "a rate above zero such as 10Hz"))
      ->type_name("HZ")
      ->group(kAccuracy);
}

void add_automatic(CLI::App& app, AccuracyTargetOptions& o) {
  add_accuracy_target(app, o);
  auto* automatic =
      app.add_flag(
             "--auto", o.automatic,
             "Measure the accuracy modes on this machine first, and use the best that meet --max-error or --min-rate")
          ->group(kAccuracy);
  for (const char* wish : {"--max-error", "--min-rate", "--by"}) app.get_option(wish)->needs(automatic);
  app.get_option("--accuracy")->excludes(automatic);
}

void add_no_return(CLI::App& app, NoReturnOption& o) {
  add_choice<bool, bool>(app, "--no-return", o.no_return_inf, {{"max", false}, {"inf", true}},
                         "Range reported for a beam without a return: max (range_max) or inf (null in JSON)")
      ->default_str("max");
  add_choice<bool, bool>(app, "--too-near", o.too_near_min, {{"inf", false}, {"min", true}},
                         "Range reported for a surface nearer than the sensor's minimum, in ROS messages, recordings "
                         "and CSV: inf (-infinity, REP 117) or min (range_min)")
      ->default_str("inf");
}

CLI::Option* add_compression(CLI::App& app, CompressionOption& o) {
  using record::Compression;
  return add_choice<Compression, Compression>(
             app, "--compression", o.compression, {{"zstd", Compression::zstd}, {"none", Compression::none}},
             "Compression of recordings: zstd, or none (twice as large, but no tick is lost if the process is killed)")
      ->default_str("zstd");
}

CLI::Option* add_images(CLI::App& app, ImagesOption& o) {
  using record::ImageMessages;
  using Files = ImageMessages::Files;
  return add_choice<ImageMessages, ImageMessages>(
             app, "--images", o.images,
             {{"compressed", {}},
              {"png", {.files = Files::png}},
              {"jpeg", {.files = Files::jpeg}},
              {"raw", {.compressed = false, .raw = true}},
              {"both", {.raw = true}}},
             "Messages with the images of cameras: compressed (CompressedImage: PNG, or JPEG of cameras with `jpeg`), "
             "png or jpeg (of all cameras), and in recordings raw (Image), or both")
      ->default_str("compressed");
}

void add_wire(CLI::App& app, WireOption& o) {
  using sensors::WireFormat;
  add_choice<WireFormat, WireFormat>(app, "--wire", o.wire,
                                     {{"farm", WireFormat::farm}, {"thesis", WireFormat::thesis}},
                                     "Layout of sensor packets: farm (docs/packets.md) or thesis (plain)")
      ->default_str("farm");
}

void add_peers(CLI::App& app, PeersOption& o) {
  app.add_option("--peers", o.peers, "File of addresses and keys used to check and sign packets (docs/robots.md)")
      ->check(not_empty("a file"))
      ->type_name("FILE");
}

void add_bind(CLI::App& app, BindOption& o) {
  app.add_option("--bind", o.bind, "Address to listen on (0.0.0.0: every interface)")
      ->check(not_empty("an address"))
      ->type_name("ADDR")
      ->capture_default_str();
}

void add_from(CLI::App& app, ReceiveOptions& o) {
  app.add_option("--from", o.from, "Accept packets only from this host (default: the first farm that sends)")
      ->check(not_empty("a host"))
      ->type_name("HOST");
}

void add_silence(CLI::App& app, ReceiveOptions& o) {
  app.add_option("--silence", o.silence, "Stop after this long without packets [s], once the first has arrived")
      ->check(in_seconds(0.1, 1e6))
      ->type_name("S")
      ->capture_default_str();
}

void add_until(CLI::App& app, DurationOption& o, const std::string& help) {
  app.add_option("--duration", o.duration, help)->check(in_seconds(0.0, 1e9))->type_name("S");
}

void add_origin(CLI::App& app, OriginOption& o, const std::string& group) {
  app.add_option("--latitude", o.latitude, "Latitude of the world's origin [degrees]")
      ->check(number(-89.0, 89.0))
      ->type_name("DEG")
      ->capture_default_str()
      ->group(group);
  app.add_option("--longitude", o.longitude, "Longitude of the world's origin [degrees]")
      ->check(number(-179.9, 179.9))
      ->type_name("DEG")
      ->capture_default_str()
      ->group(group);
}

void add_ports(CLI::App& app, PortOptions& o) {
  for (const sensors::SensorType* type : sensors::sensor_types()) {
    o.base_ports[type->id] = type->base_port;
    app.add_option(fmt::format("--{}-port", type->name), o.base_ports[type->id],
                   fmt::format("First of the {} ports", type->name))
        ->check(whole(1, 65535))
        ->type_name("PORT")
        ->capture_default_str()
        ->group(kPorts);
  }
  app.add_option("--ports-per-robot", o.ports_per_robot, "Ports per robot (default: 8, or the minimum that fits)")
      ->check(whole(1, 65535))
      ->type_name("N")
      ->group(kPorts);
  add_wire(app, o);
}

void add_bridges(CLI::App& app, BridgeOptions& o) {
  app.add_option("--ros2", o.ros2, "Open a ROS 2 node in this domain (default: ROS_DOMAIN_ID, or 0)")
      ->expected(0, 1)
      ->check(whole(0, bridges::kDdsMaxDomain))
      ->type_name("[DOMAIN]")
      ->group(kBridgeGroup);
  app.add_option("--player", o.player,
                 "Open a Player server with all robots on this port, and robot K alone on this port + K - 1 (default: "
                 "127.0.0.1:6665; 0: any free ports)")
      ->expected(0, 1)
      ->default_str("6665")
      ->type_name("[HOST:]PORT")
      ->group(kBridgeGroup);
  add_live_view(app, o.view, "a live view")->group(kBridgeGroup);
}

CLI::Option* add_live_view(CLI::App& app, std::optional<bridges::WebAddress>& view, const char* what,
                           const char* name) {
  const auto read = [&view](const std::string& text) { view = bridges::read_web_address(text); };
  return app
      .add_option_function<std::string>(
          name, read,
          fmt::format("Serve {} at this address, for a browser and for Foxglove's viewers (default: 127.0.0.1:8765)",
                      what))
      ->check(readable(bridges::read_web_address, "[HOST:]PORT such as 8765 or 0.0.0.0:8765"))
      ->expected(0, 1)
      ->default_str("8765")
      ->type_name("[HOST:]PORT");
}

void add_naming(CLI::App& app, NamingOption& o) {
  const auto choices = [](const auto& table) {
    std::vector<std::pair<std::string, std::decay_t<decltype(table[0].second)>>> words;
    for (const auto& [word, value] : table) words.emplace_back(word, value);
    return words;
  };
  add_choice(
      app, "--topics", o.naming.style, choices(record::kTopicStyles),
      "Names of topics and frames in ROS 2, Foxglove and recordings: robot (/ROBOT/scan), nav2 (the same, with a "
      "/ROBOT/tf for each), plain (/scan, for one robot) or sensor (/ROBOT/SENSOR/scan, robots in the frame "
      "world, true odometry)")
      ->default_str("robot")
      ->group(kNaming);
  add_choice(app, "--odometry", o.naming.odometry, choices(record::kOdometrySources),
             "Source of the topic odom and of odom -> base_link: encoders (exact for robots without them), exact "
             "(without errors, from the start pose) or truth (the pose in the world)")
      ->default_str("encoders")
      ->group(kNaming);
  std::vector<std::string> nodes;
  for (const auto& [word, member] : record::kExternalNodes) nodes.emplace_back(word);
  const auto set = [&o](const std::vector<std::string>& words) {
    for (const auto& [word, member] : record::kExternalNodes)
      o.naming.*member = std::find(words.begin(), words.end(), word) != words.end();
  };
  app.add_option_function<std::vector<std::string>>(
         "--external", set,
         "External nodes, whose output the farm leaves out: localizer (map -> odom), mapper (map -> odom and /map) or "
         "filter (odom -> base_link), or several")
      ->check(one_of(nodes))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("NODE,...")
      ->group(kNaming);
}

void require_any(const CLI::App& sub, const std::vector<std::string>& options, const std::vector<std::string>& wanted) {
  const auto given = [&](const std::string& name) { return sub.count(name) > 0; };
  if (std::any_of(wanted.begin(), wanted.end(), given)) return;
  for (const std::string& option : options)
    if (given(option)) throw CLI::RequiresError(option, join_or(wanted));
}

void check_naming(const CLI::App& sub, const char* readings_option) {
  require_any(sub, {"--topics", "--odometry", "--external", "--too-near"}, {"--record", "--ros2", "--view"});
  const auto option_text = [&](const char* name) {
    return sub.count(name) > 0 ? sub.get_option(name)->results().back() : std::string();
  };
  const std::string odometry = option_text("--odometry");
  const std::vector<std::string> nodes = sub.get_option("--external")->results();
  const bool other = (!odometry.empty() && odometry != "truth") ||
                     std::any_of(nodes.begin(), nodes.end(), [](const std::string& node) { return node != "mapper"; });
  if (option_text("--topics") == "sensor" && other)
    throw CLI::ValidationError("--topics",
                               "sensor has no frame odom and uses true odometry: leave out --odometry encoders or "
                               "exact and --external localizer or filter, or choose other names");
  if (readings_option == nullptr || odometry.empty() || odometry == "truth") return;
  if (sub.count(readings_option) + sub.count("--ros2") + sub.count("--view") == 0)
    throw CLI::ValidationError(
        "--odometry", fmt::format("{} requires {}: recordings without readings contain the true pose only", odometry,
                                  readings_option));
}

void add_threads(CLI::App& app, ThreadsOption& o) {
  app.add_option("--threads", o.threads, "Host threads (0: all); readings do not depend on their number")
      ->check(whole(0, 256))
      ->type_name("N");
}

CLI::Option* add_picture(CLI::App& app, std::string& file, const std::string& help) {
  return app.add_option("-o,--out", file, help)->check(picture())->type_name("FILE");
}

namespace {

void refuse_large_font(const viz::Page& page) {
  if (page.width == 0.0 || page.width >= viz::kWidthPerPoint * page.font_size) return;
  throw CLI::ValidationError(
      "--font-size",
      fmt::format("{:g} points require a width of at least {:g} mm; --size {:g} allows at most {:.3g} points",
                  page.font_size, viz::kWidthPerPoint * page.font_size, page.width, page.width / viz::kWidthPerPoint));
}

}  // namespace

void add_page(CLI::App& app, PageOption& o) {
  app.add_option_function<std::string>(
         "--size",
         [&o](const std::string& text) {
           if (const auto size = read_size(text)) o.page.width = size->x, o.page.height = size->y;
           refuse_large_font(o.page);
         },
         "Printed width of the picture, or width and maximum height [mm]; 88 is one column (default: about 226)")
      ->check(readable(read_size, "W or WxH [mm] with W from 50 to 1000 and H from 30 to 1000, such as 88 or 170x120"))
      ->type_name("W[xH]")
      ->group("Picture");
  app.add_option_function<double>(
         "--font-size",
         [&o](const double& points) {
           o.page.font_size = points;
           refuse_large_font(o.page);
         },
         "Font size of axes and legends [pt]; lines and markers scale with it (default: 7.2)")
      ->check(number(5.0, 24.0))
      ->type_name("PT")
      ->group("Picture");
  app.add_option("--dpi", o.page.dpi, "Resolution of PNG pictures [dots per inch] (default: 180)")
      ->check(number(50.0, 1200.0))
      ->type_name("N")
      ->group("Picture");
  app.add_flag_callback(
         "--no-title", [&o] { o.page.title = false; }, "Omit title and subtitle, for pictures with a caption")
      ->group("Picture");
}

void add_line_styles(CLI::App& app, PageOption& o) {
  add_choice<bool, bool>(app, "--line-styles", o.page.line_styles, {{"varied", true}, {"solid", false}},
                         "Dashes of curves: varied (distinguishable without colour) or solid (default: varied)")
      ->group("Picture");
}

void add_map_colors(CLI::App& app, PageOption& o) {
  using viz::MapColors;
  add_choice<MapColors, MapColors>(
      app, "--map-colors", o.page.map_colors, {{"ros", MapColors::ros}, {"thesis", MapColors::thesis}},
      "Colours of occupancy maps: ros (greys: occupied black, free white) or thesis (occupied blue) (default: ros)")
      ->group("Picture");
}

void add_extent(CLI::App& app, PageOption& o) {
  app.add_option_function<std::string>(
         "--extent", [&o](const std::string& text) { o.page.extent = read_extent(text); },
         "Area of the world to show [m] (default: the whole world)")
      ->check(readable(read_extent, "XMIN,YMIN,XMAX,YMAX such as -1,-1,2,1"))
      ->type_name("XMIN,YMIN,XMAX,YMAX")
      ->group("Picture");
}

void add_format(CLI::App& app, std::string& format) {
  add_choice(
      app, "--format", {"png", "svg", "pdf"}, [&format](const std::string& word) { format = word; },
      "File format of the pictures (default: png)")
      ->group("Picture");
}

CLI::Option* add_robot_names(CLI::App& app, const std::string& option, std::vector<std::string>& names,
                             const std::string& help) {
  return app.add_option(option, names, help + "; may be repeated; names may contain commas")
      ->allow_extra_args(false)
      ->check(not_empty("the name of a robot"))
      ->type_name("NAME,...");
}

void add_video_look(CLI::App& app, VideoOptions& o, CLI::Option* wanted) {
  const auto add_names = [&](const char* name, std::vector<std::string>& names, const char* help) {
    return add_robot_names(app, name, names, help)->needs(wanted)->group(kVideoGroup);
  };
  const auto in_group = [&](CLI::Option* option, const char* type) {
    option->needs(wanted)->type_name(type)->group(kVideoGroup);
  };
  in_group(app.add_option("--video-fps", o.video_fps, "Frames per second of video")
               ->check(whole(1, 120))
               ->capture_default_str(),
           "N");
  in_group(app.add_option("--video-speed", o.video_speed, "Simulated seconds per second of video")
               ->check(number(0.001, 1e6))
               ->capture_default_str(),
           "X");
  in_group(app.add_option_function<std::string>(
                  "--video-size",
                  [&o](const std::string& text) { std::tie(o.video_width, o.video_height) = *read_pixels(text); },
                  "Width and height of a frame [px], even (default: 1280x720)")
               ->check(readable(read_pixels, "WxH [px], even numbers from 16 to 4096, such as 1280x720")),
           "WxH");
  CLI::Option* const extent =
      app.add_option_function<std::string>(
             "--video-extent", [&o](const std::string& text) { o.video_extent = read_extent(text); },
             "Area of the world to show [m] (default: the whole world)")
          ->check(readable(read_extent, "XMIN,YMIN,XMAX,YMAX such as -1,-1,2,1"));
  in_group(extent, "XMIN,YMIN,XMAX,YMAX");
  CLI::Option* const follow =
      add_names("--video-follow", o.video_follow, "Robots that the camera follows")->excludes(extent);
  in_group(app.add_option("--video-around", o.video_around, "Area shown around the followed robots [m]")
               ->check(number(0.01, 1e6))
               ->needs(follow)
               ->capture_default_str(),
           "M");
  add_names("--video-readings", o.video_readings, "Robots whose scans and cones are shown");
}

void add_video(CLI::App& app, VideoOptions& o, const std::string& help) {
  add_video_look(app, o,
                 app.add_option("--video", o.video, help)->check(video())->type_name("FILE.webm")->group(kVideoGroup));
}

void add_part(CLI::App& app, PartOption& o) {
  add_robot_names(app, "--robots", o.robots, "Names of the robots to include (default: all)");
  app.add_option("--from", o.from, "Start of the time range [s] (default: 0)")
      ->check(in_seconds(0.0, 1e9))
      ->type_name("S");
  app.add_option("--to", o.to, "End of the time range [s] (default: the end of the recording)")
      ->check(in_seconds(0.0, 1e9))
      ->type_name("S");
}

void add_recording(CLI::App& app, RecordingOption& o) {
  app.add_option("recording", o.recording, "Folder of the recording")->required()->check(recording())->type_name("DIR");
}

void add_sensor_type(CLI::App& app, SenseOptions& o) {
  std::vector<std::pair<std::string, std::uint8_t>> types;
  for (const sensors::SensorType* type : sensors::sensor_types()) types.emplace_back(type->name, type->id);
  add_choice(app, "--type", o.type, types, "Type of the sensor (default: the robot's first)");
}

void add_seed(CLI::App& app, SeedOption& o, const std::string& what) {
  app.add_option("--seed", o.seed, what)->check(whole(0, UINT64_MAX))->type_name("K")->capture_default_str();
}

void add_robots(CLI::App& app, CloneOptions& o) {
  auto* robots = app.add_option("--robots", o.robots, "Replace the robots with this many copies of one, at free poses")
                     ->check(whole(1, 65535))
                     ->type_name("N");
  app.add_option("--of", o.of, "Robot to copy (default: the first with sensors)")
      ->check(not_empty("the name of a robot"))
      ->needs(robots)
      ->type_name("NAME");
  add_seed(app, o, "Seed of poses, decisions and noise");
}

void add_robot_from(CLI::App& app, WorldOptions& o) {
  CLI::Option* const from = app.add_option("--robot-from", o.robot_from,
                                           "Robot or robot type of another world file: added to a world without "
                                           "robots, such as a ROS map, or copied by --robots (docs/worlds.md)")
                                ->check(not_empty("FILE:NAME such as worlds/robots.inc:create"))
                                ->type_name("FILE:NAME");
  if (CLI::Option* const of = app.get_option_no_throw("--of"); of != nullptr) from->excludes(of);
}

void add_in_process(CLI::App& app, InProcessOption& o) {
  app.add_flag("--in-process", o.in_process,
               "Run plug-ins and Python in this process, e.g. for a debugger (default: in a child process, so that a "
               "crash is reported)");
}

void add_timeout(CLI::App& app, double& seconds, const std::string& job) {
  app.add_option(
         "--timeout", seconds,
         fmt::format("Wall-clock time limit per {} [s], after which it is stopped and fails (default: none)", job))
      ->check(in_seconds(1e-3, 1e9))
      ->type_name("S");
}

void add_controller(CLI::App& app, ControllerOptions& o) {
  const std::vector<std::string_view> all = control::controller_names();
  const std::vector<std::string> names(all.begin(), all.end());
  const Validator known = one_of(names);
  app.add_option(
         "--controller", o.controller,
         "Controller of the robots: " + join_or(names) +
             ", or a file: a plug-in (./libmine.so) or a Python class (mine.py:MyClass); overrides `ctrl` of the "
             "world file")
      ->check([=](const std::string& name) { return base::names_a_plugin(name) ? std::string() : known(name); })
      ->each([&o](const std::string&) { o.controller_given = true; })
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--set", o.set,
                 "Setting of the controller, such as kp=0.5, park=13.4, checkpoints=1,2 or \"[1 2]\" (may be repeated)")
      ->check(readable(read_setting, "KEY=VALUE such as kp=0.5"))
      ->type_name("KEY=VALUE");
  app.add_flag_function(
      "--localize,!--no-localize", [&o](std::int64_t count) { o.localize = count > 0; },
      "Robots with encoders drive by the pose estimated from these, their gyro and their GPS receiver (default; "
      "same as --set localize=true). --no-localize: by their true pose, in `robot` with --cameras by these "
      "alone");
  add_in_process(app, o);
}

}  // namespace sf::apps
