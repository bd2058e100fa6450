// Subcommands that inspect worlds, devices and V2X messages.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "apps/commands/commands.h"
#include "apps/options/option_groups.h"
#include "apps/options/option_parsers.h"
#include "apps/options/subcommands.h"
#include "base/installation.h"

namespace sf::apps {

namespace {

void add_devices(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("devices",
                                     "List the Vulkan devices with their self-checks, the chosen one, and why others "
                                     "are refused (exit code 3 if none is usable)");
  auto& o = add_command(*sub, call, devices);
  add_examples(*sub, {"--json"});
  add_json(*sub, o);
  add_device(*sub, o);
}

void add_check(CLI::App& app, Call& call) {
  CLI::App* sub =
      app.add_subcommand("check", "Summarize a world as the farm reads it, and list every warning with its line");
  auto& o = add_command(*sub, call, check);
  add_examples(*sub, {"worlds/cave.world", "worlds/simville/simville.mdf --rndf worlds/simville/simville.rndf"});
  add_world(*sub, o);
  add_accuracy(*sub, o);
  sub->add_option("--rndf", o.rndf, "Road network that a mission (.mdf) is checked against")
      ->check(not_empty("a file"))
      ->type_name("FILE");
  sub->add_option("--rate", o.rate, "Intended `serve --rate` in ticks per second: lists the sensors that are faster")
      ->check(number(0.1, 10000.0))
      ->type_name("HZ");
  add_json(*sub, o);
}

void add_draw(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("draw", "Draw a world from above, as the farm reads it");
  auto& o = add_command(*sub, call, draw);
  add_examples(*sub, {"worlds/simville/simville.world -o simville.png"});
  add_world(*sub, o);
  add_picture(*sub, o.out)->required();
  add_page(*sub, o);
  add_extent(*sub, o);
}

void add_field(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("field", "Plot the magnetic field of a world at one height and along a line");
  auto& o = add_command(*sub, call, field);
  add_examples(*sub, {"worlds/six_magnets.world --height 0.05 -o field.png"});
  add_world(*sub, o);
  add_device(*sub, o);
  sub->add_option("--height", o.height, "Height of the plane [m]")
      ->required()
      ->check(number(-1e6, 1e6))
      ->type_name("Z");
  add_picture(*sub, o.out)->required();
  add_page(*sub, o);
  add_line_styles(*sub, o);
  sub->add_option_function<std::string>(
         "--line", [&o](const std::string& text) { o.line = read_line(text); },
         "End points of the profile [m] (default: along the magnets)")
      ->check(readable(read_line, "X0,Y0,X1,Y1 of two points such as -1,0,2,0.5"))
      ->type_name("X0,Y0,X1,Y1");
  sub->add_option_function<std::string>(
         "--extent", [&o](const std::string& text) { o.extent = read_extent(text); },
         "Area that the map shows at least [m] (default: all magnets)")
      ->check(readable(read_extent, "XMIN,YMIN,XMAX,YMAX such as -1,-1,2,1"))
      ->type_name("XMIN,YMIN,XMAX,YMAX");
  sub->add_option("--csv", o.csv, "CSV file to write the profile to")
      ->check(new_file("profile.csv"))
      ->type_name("FILE");
}

/// @return why the file is no image; empty if it is
std::string image_file(const std::string& text) {
  std::filesystem::path file(text);
  if (file.extension() == ".png" || is_jpeg(text)) return "";
  return fmt::format("images are PNG or JPEG files; write {}", file.replace_extension(".png").string());
}

void check_sense(const CLI::App& sense) {
  if (sense.count("--image") == 0 || !is_jpeg(sense.get_option("--out")->as<std::string>())) return;
  const auto kind = sense.get_option("--image")->as<std::string>();
  if (kind != "colour" && kind != "mono")
    throw CLI::ValidationError("--out", kind + " would change in a JPEG file; write PNG");
}

void add_sense(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("sense", "Compute one reading of one sensor, without noise, to check a world");
  auto& o = add_command(*sub, call, sense, [sub] { check_sense(*sub); });
  add_examples(*sub, {"worlds/rooms.world --pose 1,2,90", "worlds/rooms.world --robot roomba1 --type laser --json"});
  add_world(*sub, o);
  add_accuracy(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_no_return(*sub, o);
  sub->add_option_function<std::string>(
         "--pose", [&o](const std::string& text) { o.pose = read_tilted_pose(text); },
         "Pose of the robot's origin on the ground [m, degrees], also as X,Y,Z,ROLL,PITCH,YAW (default: its pose in "
         "the world)")
      ->check(readable(read_tilted_pose,
                       "X,Y,YAW_DEG such as 1.5,-2,90 or X,Y,Z,ROLL_DEG,PITCH_DEG,YAW_DEG, each within "
                       "1e7, roll within 180 and pitch within 90 degrees"))
      ->type_name("X,Y,YAW_DEG");
  sub->add_option("--robot", o.robot, "Name of the robot (default: the first with a sensor)")->type_name("NAME");
  add_robot_from(*sub, o);
  add_sensor_type(*sub, o);
  const std::vector<std::pair<std::string, ImageKind>> kinds{{"depth", ImageKind::depth},
                                                             {"labels", ImageKind::labels},
                                                             {"normals", ImageKind::normals},
                                                             {"colour", ImageKind::colour},
                                                             {"mono", ImageKind::mono}};
  CLI::Option* const out =
      sub->add_option("-o,--out", o.out, "PNG or JPEG file of --image")->check(image_file)->type_name("FILE");
  CLI::Option* const image =
      sub->add_option_function<std::string>(
             "--image",
             [&o, kinds](const std::string& word) {
               o.image = std::ranges::find(kinds, word, &std::pair<std::string, ImageKind>::first)->second;
             },
             "Write this image of a camera: depth (16 bits, mm), labels (16 bits: 0 nothing, 1 floor, 2 + row of the "
             "model), normals, colour or mono (8 bits)")
          ->check(CLI::IsMember({"depth", "labels", "normals", "colour", "mono"}))
          ->type_name("KIND")
          ->needs(out);
  out->needs(image);
  sub->add_option("--sensor", o.sensor, "Number of the sensor, from 0: within --type, or across all types without it")
      ->check(whole(0, 65535))
      ->type_name("N")
      ->capture_default_str();
}

void add_v2x(CLI::App& app, Call& call) {
  using Action = V2xOptions::Action;
  CLI::App* sub = app.add_subcommand("v2x",
                                     "Decode SAE J2735 SPaT and MAP messages (UPER) to JSON or XML, encode JSON, or "
                                     "export a world's traffic lights as messages");
  auto& o = add_command(*sub, call, v2x_messages, [sub] {
    const auto action = sub->get_option("action")->as<std::string>();
    if (sub->count("--xml") > 0 && action != "decode")
      throw CLI::ValidationError("--xml", "requires the action decode");
    for (const std::string option : {"--time", "--latitude", "--longitude"})
      if (sub->count(option) > 0 && action != "export")
        throw CLI::ValidationError(option, "requires the action export");
  });
  add_examples(*sub, {"decode spat.hex", "decode --xml map.bin", "encode spat.json > spat.hex",
                      "export worlds/simville/simville.world --time 9"});
  const std::vector<std::pair<std::string, Action>> actions{
      {"decode", Action::decode}, {"encode", Action::encode}, {"export", Action::export_world}};
  add_choice(*sub, "action", o.action, actions,
             "decode: frames to one line of JSON each; encode: the reverse; export: MAP and SPaT of each intersection "
             "of a world in hexadecimal digits")
      ->required();
  sub->add_option(
         "file", o.file,
         "To decode: hexadecimal digits, one frame per line, or binary, one frame after another; to encode: JSON "
         "as decode prints it (both: - is standard input); to export: a world file")
      ->required()
      ->check(not_empty("a file"))
      ->transform(base::installed_file)
      ->type_name("FILE");
  sub->add_flag("--xml", o.xml, "Decode to XML (XER) instead of JSON");
  sub->add_option("--time", o.time, "Simulated time [s] of the SPaT; time 0 is the start of the year in UTC")
      ->check(in_seconds(0.0, 31'536'000.0))
      ->type_name("S")
      ->capture_default_str()
      ->group("Export");
  add_origin(*sub, o, "Export");
}

void add_explain(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "explain",
      "Report the structures and computations that a world requires, and the cost of each sensor type on this machine");
  auto& o = add_command(*sub, call, explain);
  add_examples(*sub, {"worlds/simville/simville.world", "robots.world --graph graph.png"});
  add_world(*sub, o);
  add_accuracy(*sub, o);
  add_json(*sub, o);
  add_device(*sub, o);
  add_robots(*sub, o);
  add_robot_from(*sub, o);
  add_threads(*sub, o);
  sub->add_option("--graph", o.graph, "Draw the derived sensors and their inputs instead of measuring")
      ->check(picture())
      ->expected(0, 1)
      ->default_str("graph.png")
      ->type_name("FILE")
      ->group("Graph");
}

}  // namespace

void add_inspect_commands(CLI::App& app, Call& call) {
  add_devices(app, call);
  add_check(app, call);
  add_draw(app, call);
  add_field(app, call);
  add_sense(app, call);
  add_explain(app, call);
  add_v2x(app, call);
}

}  // namespace sf::apps
