// Subcommands that plot, export and show recordings.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <filesystem>

#include "apps/commands/commands.h"
#include "apps/options/option_groups.h"
#include "apps/options/option_parsers.h"
#include "apps/options/subcommands.h"
#include "robots/estimation/regression.h"

namespace sf::apps {

namespace {

CLI::Option* add_height(CLI::App& app, double& height) {
  return app.add_option("--height", height, "Height of the plane of the magnetic field [m]")
      ->check(number(-1e6, 1e6))
      ->type_name("Z")
      ->capture_default_str();
}

CLI::Option* add_every(CLI::App& app, double& every, const std::string& help) {
  return app.add_option("--every", every, help)->check(in_seconds(1e-3, 1e6))->type_name("S")->capture_default_str();
}

/// @param wanted option without which there are no frames
void add_video_camera(CLI::App& app, VideoOptions& o, const char* wanted) {
  CLI::Option* const camera = app.add_option("--video-camera", o.video_camera,
                                             "Camera whose recorded images are the frames, instead of the world from "
                                             "above: ROBOT, for its first one, or ROBOT:CAMERA")
                                  ->check(not_empty("the name of a robot"))
                                  ->needs(wanted)
                                  ->type_name("CAMERA")
                                  ->group(kVideoGroup);
  for (const char* const other : {"--video-size", "--video-extent", "--video-follow", "--video-readings"})
    camera->excludes(other);
}

void add_plot(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "plot",
      "Plot trajectories, an occupancy map, readings and traffic lights of a recorded run, or the metrics of a sweep");
  auto& o = add_command(*sub, call, plot, [sub] {
    if (sub->count("--video") == 0) return;
    for (const std::string option :
         {"--format", "--csv", "--size", "--dpi", "--no-title", "--extent", "--font-size", "--line-styles",
          "--map-colors", "--label", "--elements", "--curves", "--allan", "--over", "--x-axis"})
      if (sub->count(option) > 0)
        throw CLI::ValidationError(option, "changes figures, but --video writes none; leave out one of the two");
    if (sub->count("--out") == 0) return;
    const std::filesystem::path folder = sub->get_option("--out")->as<std::string>();
    const std::filesystem::path file = sub->get_option("--video")->as<std::string>();
    throw CLI::ValidationError("--out",
                               fmt::format("is the folder of figures, but --video writes none; write --video {}",
                                           (folder / file.filename()).string()));
  });
  add_examples(*sub, {"out/run", "out/run -o figures --format pdf --size 88 --no-title --robots robot1,robot2",
                      "out/sweep --format pdf --size 88"});
  const auto is_table_or = [check = recording()](const std::string& text) {
    return text.ends_with(".csv") ? std::string() : check(text);
  };
  sub->add_option("recording", o.recording, "Folder of the recording or of a sweep; with --allan also a CSV file")
      ->required()
      ->check(is_table_or)
      ->type_name("DIR");
  sub->add_option("-o,--out", o.out, "Folder for the pictures (default: the recording's own)")
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  add_format(*sub, o.format);
  sub->add_flag("--csv", o.csv, "Also write every plotted curve as a CSV file next to its figure")->group("Picture");
  add_page(*sub, o);
  add_line_styles(*sub, o);
  add_map_colors(*sub, o);
  add_extent(*sub, o);
  add_robot_names(*sub, "--label", o.labels,
                  "Robots to label and colour in the plot of trajectories, or all (default: up to ten)");
  auto* elements = sub->add_option("--elements", o.elements,
                                   "Sensor elements to plot as curves (default: all; more than seven as a heat map)")
                       ->delimiter(',')
                       ->allow_extra_args(false)
                       ->check(whole(0, UINT32_MAX))
                       ->type_name("N,...");
  sub->add_flag("--curves", o.curves, "Plot the readings of many elements as curves instead of heat maps")
      ->excludes(elements);
  sub->add_flag("--allan", o.allan,
                "Plot only the Allan deviations of imus and gyros, of robots at rest, with the stated ones; or those "
                "of the columns of a CSV file");
  constexpr const char* kSweeps = "Sweeps (docs/sweeps.md)";
  sub->add_option("--over", o.over, "Parameter on the x axis (default: the first with different numeric values)")
      ->check(not_empty("the name of a parameter"))
      ->type_name("PARAMETER")
      ->group(kSweeps);
  using viz::AxisScale;
  add_choice<AxisScale, AxisScale>(
      *sub, "--x-axis", o.x_axis,
      {{"auto", AxisScale::automatic}, {"linear", AxisScale::linear}, {"log", AxisScale::logarithmic}},
      "Scale of the x axis: auto selects log if successive values have about equal ratios (default: auto)")
      ->group(kSweeps);
  add_video(*sub, o, "Video to write instead of pictures (VP9 in WebM, encoded by FFmpeg)");
  add_video_camera(*sub, o, "--video");
  add_part(*sub, o);
  add_device(*sub, o);
}

void add_export(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand("export",
                                     "Write a recorded run's trajectories and readings as CSV, its geometry as VTK "
                                     "files for ParaView, or the scans of lidars as point clouds");
  auto& o = add_command(*sub, call, export_recording, [sub] { require_any(*sub, {"--every", "--height"}, {"--vtk"}); });
  add_examples(*sub, {"out/run -o tables", "out/run --vtk --every 0.5 -o paraview", "out/run --clouds pcd -o clouds"});
  add_recording(*sub, o);
  sub->add_option("-o,--out", o.out, "Folder for the files")
      ->required()
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  sub->add_flag("--vtk", o.vtk,
                "Write walls, roads, robots, trajectories, clouds, scans, occupancy and field as VTK files");
  add_choice<CloudFormat, CloudFormat>(*sub, "--clouds", o.clouds,
                                       {{"pcd", CloudFormat::pcd}, {"ply", CloudFormat::ply}},
                                       "Write the scans of lidars as point clouds: pcd (all beams, in the sensor's "
                                       "frame, with its pose) or ply (echoes, in the world)")
      ->excludes("--vtk");
  add_every(*sub, o.every, "Simulated time between the files of a VTK series [s]");
  add_height(*sub, o.height);
  add_part(*sub, o);
  add_device(*sub, o);
}

void add_derive(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "derive",
      "Compute derived sensors from the readings of a recording: sensorfarm's own, MCAP with ROS 2 messages, or CSV "
      "(docs/recordings.md; exit code 1 if recorded derived readings differ)");
  auto& o = add_command(*sub, call, derive);
  add_examples(*sub, {"out/run --with pose.toml -o out/derived", "drive.mcap --with imu_and_gps.toml -o out/derived"});
  sub->add_option(
         "recording", o.recording,
         "Folder of the recording; or an MCAP file, a CSV file or a folder of such files, with [[input]] in FILE")
      ->required()
      ->check(not_empty("a recording"))
      ->type_name("PATH");
  sub->add_option("--with", o.with, "File of derived sensors, and of the recording's inputs (.toml)")
      ->required()
      ->check(not_empty("a file"))
      ->type_name("FILE");
  sub->add_option("-o,--out", o.out, "Folder for the recording (run.mcap) and one table per derived sensor (NAME.csv)")
      ->required()
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  add_threads(*sub, o);
}

void add_identify(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "identify",
      "Learn a model of one sensor from others of its robot, for derived sensors of type `model` (docs/derived.md)");
  auto& o = add_command(*sub, call, identify);
  add_examples(*sub, {"out/run1 out/run2 --robot roomba0 --inputs magnetometer --output laneedge -o edge.toml"});
  sub->add_option("recordings", o.recordings, "Folders of recordings with readings (run --record-readings)")
      ->required()
      ->type_name("DIR...");
  sub->add_option("--robot", o.robot, "Robot whose sensors these are")->required()->type_name("NAME");
  sub->add_option("--inputs", o.inputs, "Sensors that the model is computed from, separated by commas")
      ->required()
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("TYPE[:NUMBER],...");
  sub->add_option("--output", o.output, "Sensor whose first number the model gives")
      ->required()
      ->type_name("TYPE[:NUMBER]");
  sub->add_option("--rate", o.rate, "Steps of the model per second")
      ->check(number(1e-3, 1e4))
      ->type_name("HZ")
      ->capture_default_str();
  sub->add_option("--between", o.between, "Leave out outputs that are not between these two values")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->expected(2)
      ->check(number(-1e18, 1e18))
      ->type_name("LEAST,MOST");
  sub->add_option("--where", o.where,
                  "Leave out steps at which this number of an input is not between LEAST and MOST; may be repeated")
      ->allow_extra_args(false)
      ->type_name("NAME=LEAST,MOST");
  sub->add_option("--kinds", o.kinds, "Kinds of models to try: arx, narx, network (default: all)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(one_of({"arx", "narx", "network"}))
      ->type_name("KIND,...");
  sub->add_option("--lags", o.lags, "Numbers of steps to try (default: 1,2,4)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(whole(1, estimation::kMostLags))
      ->type_name("N,...");
  sub->add_option("--hidden", o.hidden, "Numbers of sigmoids to try, of narx and network (default: 4,8)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(whole(1, estimation::kMostHidden))
      ->type_name("N,...");
  sub->add_option("--folds", o.folds, "Parts of the recordings in cross-validation")
      ->check(whole(2, 1000))
      ->type_name("N")
      ->capture_default_str();
  sub->add_option("--seed", o.seed, "Seed of the first weights")
      ->check(whole(0, UINT64_MAX))
      ->type_name("N")
      ->capture_default_str();
  sub->add_flag("--measured", o.measured,
                "Choose for models that have the measured output as an input, by the error of one step");
  sub->add_option("-o,--out", o.out, "File for the model (.toml)")
      ->required()
      ->check(not_empty("a file"))
      ->type_name("FILE");
  add_threads(*sub, o);
}

void add_view(CLI::App& app, Call& call) {
  constexpr const char* kGroup = "VTK window";
  CLI::App* sub = app.add_subcommand(
      "view", "Show a recorded run in a browser with a time slider, in Foxglove's viewers, or in a window");
  auto& o = add_command(*sub, call, view, [sub] {
    for (const char* name : {"--robots", "--from", "--to"})
      if (sub->count(name) > 0 && sub->count("--3d") + sub->count("--frames") == 0)
        throw CLI::RequiresError(name, "--3d or --frames");
  });
  add_examples(*sub, {"out/run", "out/run --port 8800", "out/run --3d", "out/run --frames out/frames"});
  add_recording(*sub, o);
  sub->add_option_function<std::string>(
         "--port", [&o](const std::string& text) { o.port = *bridges::read_web_address(text); },
         "TCP port of the page, and HOST to open it to other machines (default: 127.0.0.1:8765; port 0: any free port)")
      ->check(readable(bridges::read_web_address, "[HOST:]PORT such as 8765 or 0.0.0.0:8765"))
      ->type_name("[HOST:]PORT");
  auto* frames = sub->add_option("--frames", o.frames,
                                 "Folder for the frames of a video as PNG files, for any encoder, instead of the page")
                     ->check(not_empty("a folder"))
                     ->excludes("--port")
                     ->type_name("DIR");
  add_video_look(*sub, o, frames);
  add_video_camera(*sub, o, "--frames");
  auto* window = sub->add_flag("--3d", o.three_d,
                               "Open a 3-D window (VTK): walls, robots, beams, clouds, magnetic field, a time slider")
                     ->excludes(frames)
                     ->group(kGroup);
  add_every(*sub, o.every, "Simulated time between two frames [s]")->needs(window)->group(kGroup);
  add_height(*sub, o.height)->needs(window)->group(kGroup);
  sub->add_option("--time", o.time, "Simulated time to start at [s]")
      ->needs(window)
      ->check(in_seconds(0.0, 1e9))
      ->type_name("S")
      ->capture_default_str()
      ->group(kGroup);
  sub->add_option("--screenshot", o.screenshot, "PNG file to write instead of opening a window")
      ->needs(window)
      ->check(new_file("view.png"))
      ->type_name("FILE")
      ->group(kGroup);
  add_part(*sub, o);
  add_device(*sub, o);
}

}  // namespace

void add_export_commands(CLI::App& app, Call& call) {
  add_plot(app, call);
  add_export(app, call);
  add_derive(app, call);
  add_identify(app, call);
  add_view(app, call);
}

}  // namespace sf::apps
