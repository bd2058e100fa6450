// Subcommands that export recordings to other programs and windows.

#include <CLI/CLI.hpp>

#include "apps/commands/commands.h"
#include "apps/options/option_groups.h"
#include "apps/options/option_parsers.h"
#include "apps/options/subcommands.h"

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

void add_export(CLI::App& app, Call& call) {
  CLI::App* sub = app.add_subcommand(
      "export", "Write a recorded run's trajectories and readings as CSV, or its geometry as VTK files for ParaView");
  auto& o = add_command(*sub, call, export_recording, [sub] { require_any(*sub, {"--every", "--height"}, {"--vtk"}); });
  add_examples(*sub, {"out/run -o tables", "out/run --vtk --every 0.5 -o paraview"});
  add_recording(*sub, o);
  sub->add_option("-o,--out", o.out, "Folder for the files")
      ->required()
      ->check(not_empty("a folder"))
      ->type_name("DIR");
  sub->add_flag("--vtk", o.vtk, "Write walls, roads, robots, trajectories, scans, occupancy and field as VTK files");
  add_every(*sub, o.every, "Simulated time between the files of a VTK series [s]");
  add_height(*sub, o.height);
  add_part(*sub, o);
  add_device(*sub, o);
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
  auto* window =
      sub->add_flag("--3d", o.three_d, "Open a 3-D window (VTK): walls, robots, beams, magnetic field, a time slider")
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
  add_export(app, call);
  add_view(app, call);
}

}  // namespace sf::apps
