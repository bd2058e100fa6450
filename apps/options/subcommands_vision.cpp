// Subcommands for cameras.

#include <CLI/CLI.hpp>

#include "apps/commands/commands.h"
#include "apps/options/option_groups.h"
#include "apps/options/option_parsers.h"
#include "apps/options/subcommands.h"
#include "base/installation.h"
#include "vision/camera.h"
#include "vision/follow.h"

namespace sf::apps {

namespace {

void add_rendered(CLI::App& app, VpsOptions& o) {
  constexpr const char* kGroup = "Rendered images, with known ground truth";
  auto* rendered =
      app.add_option("--rendered", o.rendered, "Render the camera images of a testbed with this many moving tags")
          ->check(whole(1, 1000))
          ->type_name("TAGS")
          ->group(kGroup);
  app.add_option("--speed", o.speed, "Speed of the fastest rendered tag [m/s]")
      ->check(number(0.0, 100.0))
      ->type_name("V")
      ->capture_default_str()
      ->needs(rendered)
      ->group(kGroup);
  app.add_option("--occluders", o.occluders, "Number of discs that pass over the rendered tags and occlude them")
      ->check(whole(0, 100))
      ->type_name("N")
      ->needs(rendered)
      ->group(kGroup);
  app.add_option("--robots", o.robots,
                 "Render images, in real time, of robots that report their true states to this UDP port "
                 "(`sensorfarm robot --truth`)")
      ->check(whole(1, 65535))
      ->type_name("PORT")
      ->excludes(rendered)
      ->group(kGroup);
}

void refuse_bind_alone(const CLI::App& sub) {
  if (sub.count("--bind") > 0 && sub.count("--robots") + sub.count("--readings") == 0)
    throw CLI::ValidationError("--bind", "requires --robots or --readings");
}

void add_vps(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "vps",
      "Virtual positioning system: detect tags in the images of overhead cameras and send a TAG packet for each");
  auto& o = add_command(*sub, call, vps, [sub] {
    refuse_bind_alone(*sub);
    for (const char* drawn : {"--rendered", "--robots"})
      if (sub->count("--input") > 0 && sub->count(drawn) > 0)
        throw CLI::ValidationError("--input", fmt::format("cannot be used with {}, which renders the images", drawn));
    require_any(*sub, {"--seed"}, {"--rendered", "--robots"});
    require_any(*sub, {"--world"}, {"--overlay", "--view"});
  });
  add_examples(
      *sub, {"worlds/testbed.toml --rendered 30 --images 20",
             "lab.toml --input north=/dev/video0 --input south=/dev/video1 --send 192.168.1.5:9000",
             "lab.toml --input north=photographs --overlay out/pictures", "worlds/testbed.toml --rendered 8 --follow 3",
             "lab.toml --input north=\"gstreamer:v4l2src device=/dev/video0\" --view",
             "worlds/testbed.toml --robots 9200 --send 127.0.0.1:9100",
             "lab.toml --overlay out/pictures --world lab.world --readings 9300"});
  sub->add_option("testbed", o.testbed, "Testbed file: cameras and tags (docs/vps.md)")
      ->required()
      ->transform(base::installed_file)
      ->type_name("FILE");
  add_json(*sub, o);
  sub->add_option_function<std::vector<std::string>>(
         "--input",
         [&o](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) o.inputs.push_back(*read_setting(text));
         },
         "Source of a camera's images: /dev/videoN, firewire:N, gstreamer:PIPELINE, a video, an image or a folder of "
         "images (may be repeated; default: the file's `source`)")
      ->check(readable(read_setting, "CAMERA=SOURCE"))
      ->allow_extra_args(false)
      ->type_name("CAMERA=SOURCE");
  add_rendered(*sub, o);
  add_seed(*sub, o, "Seed of rendered images");
  sub->add_option(
         "--images", o.images,
         "Stop after this number of images per camera (0: all, but 30 if rendered without --real-time or --view)")
      ->check(whole(0, 1'000'000'000))
      ->type_name("N");
  add_until(*sub, o, "Stop after this long by the images' times [s] (0: at the end of the images, or at Ctrl-C)");
  sub->add_flag("--real-time", o.real_time,
                "Process videos, folders and rendered images at the cameras' rate (--view does so, too)");
  sub->add_option("--follow", o.follow,
                  "Follow only the tags with these ids from camera to camera: cameras that cannot see them sleep, and "
                  "the others search only where they can be (off: none; default: the file's [follow])")
      ->check(readable([](const std::string& text) { return text == "off" || !vision::read_tags(text).empty(); },
                       "1 to 256 ids from 0 to 65535, such as 7,9, or off"))
      ->type_name("IDS");
  sub->add_option("--send", o.send, "Address for TAG packets of tags that have no address in the file")
      ->check(not_empty("HOST:PORT"))
      ->type_name("HOST:PORT");
  add_peers(*sub, o);
  sub->add_option("--track", o.track, "CSV file to write every pose and velocity to")
      ->check(new_file("track.csv"))
      ->type_name("FILE");
  auto* overlay = sub->add_option("--overlay", o.overlay,
                                  "Folder for the images with ids and poses drawn over them, or a video (*.avi) of "
                                  "these; at most 20000 per camera")
                      ->check(not_empty("a folder or a video"))
                      ->type_name("PATH");
  sub->add_option("--every", o.every, "Draw over only one image in N")
      ->check(whole(1, 1'000'000))
      ->needs(overlay)
      ->type_name("N")
      ->capture_default_str();
  sub->add_option("--world", o.world,
                  "World whose walls and lane markings are drawn over the pictures of --overlay and --view")
      ->check(not_empty("a world"))
      ->type_name("WORLD");
  sub->add_option("--readings", o.readings,
                  "UDP port for readings of the world's robots (`serve --mirror`): draws their beams and lane edges at "
                  "the poses that the cameras measure, and their occupancy maps")
      ->check(whole(1, 65535))
      ->needs("--world")
      ->type_name("PORT");
  add_live_view(*sub, o.view, "the images with ids, poses and speeds of their tags");
  add_bind(*sub, o);
}

void add_calibrate(CLI::App& app, Call& call) {
  CLI::App* sub =
      app.add_subcommand("calibrate",
                         "Calibrate a camera and print its [[camera]] section of a testbed file, with the residual: "
                         "intrinsics from images of a chessboard, or the pose from images of surveyed tags");
  auto& o = add_command(*sub, call, calibrate, [sub] {
    for (const char* board : {"--columns", "--rows", "--square"})
      if (sub->count(board) > 0 && sub->count("--survey") > 0)
        throw CLI::ValidationError(board, "describes a chessboard, but --survey uses tags");
  });
  add_examples(*sub, {"photographs --columns 9 --rows 6 --square 0.025 --name north > lab.toml",
                      "photographs --columns 6 --rows 4 --square 0.04 --charuco aruco_4x4_50 --marker 0.03",
                      "/dev/video0 --survey lab.toml --name north"});
  sub->add_option("images", o.images,
                  "Folder of images, or a video, of the chessboard at different positions and tilts")
      ->required()
      ->type_name("SOURCE");
  sub->add_option("--columns", o.columns, "Inner corners along a row of the board")
      ->check(whole(3, 100))
      ->type_name("N")
      ->capture_default_str();
  sub->add_option("--rows", o.rows, "Inner corners along a column of the board")
      ->check(whole(3, 100))
      ->type_name("N")
      ->capture_default_str();
  sub->add_option("--square", o.square, "Side length of a square [m]")
      ->check(number(1e-4, 10.0))
      ->type_name("M")
      ->capture_default_str();
  auto* charuco = sub->add_option("--charuco", o.charuco,
                                  "The board has tags of this dictionary, such as aruco_4x4_50, in its white squares "
                                  "(ChArUco), so images may show only a part of it")
                      ->check(not_empty("a dictionary"))
                      ->type_name("DICTIONARY");
  auto* marker = sub->add_option("--marker", o.marker, "Side length of these tags [m]")
                     ->check(number(1e-4, 10.0))
                     ->type_name("M")
                     ->needs(charuco);
  charuco->needs(marker);
  sub->add_option("--survey", o.testbed,
                  "Estimate the camera's pose instead: testbed file with its intrinsics and with [[survey]] sections "
                  "for the tags in the images")
      ->check(not_empty("a testbed file"))
      ->excludes(charuco)
      ->type_name("FILE");
  sub->add_option("--name", o.name, "Name of the camera")
      ->check(readable(vision::is_camera_name, vision::kCameraNameForm))
      ->type_name("NAME")
      ->capture_default_str();
}

}  // namespace

void add_vision_commands(CLI::App& app, Call& call) {
  add_vps(app, call);
  add_calibrate(app, call);
}

}  // namespace sf::apps
