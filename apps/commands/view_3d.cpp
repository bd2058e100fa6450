#include "apps/commands/view_3d.h"

#include <algorithm>

#include "apps/commands/commands.h"
#include "apps/commands/field_grid.h"
#include "apps/commands/scan_replay.h"
#include "apps/options/open_device.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "gpu/device.h"
#include "scenarios/recorded_states.h"
#include "viz/png.h"
#include "viz/vtk_window.h"
#include "viz/world_geometry.h"

namespace sf::apps {

namespace {

std::vector<double> times_of(const RecordingPart& part, const std::vector<std::size_t>& ticks) {
  std::vector<double> times;
  for (const std::size_t tick : ticks)
    for (const auto& states : part.recording.states)
      if (tick < states.size()) {
        times.push_back(1e-9 * static_cast<double>(states[tick].time));
        break;
      }
  return times;
}

}  // namespace

int view_3d(const ViewOptions& options) {
  const RecordingPart part = open_part(options.recording, options);
  const world::World world = scenarios::recorded_world(part.recording);
  const std::vector<std::size_t> ticks = ticks_apart(part, options.every);
  viz::Scene3d scene;
  scene.times = times_of(part, ticks);
  if (scene.times.empty()) throw base::InputError(part.recording.file, 0, "has no tick, so there is nothing to see");

  gpu::Device device = open_device(options);
  ScanReplay replay(part, world, device);
  scene.title = "sensorfarm: " + part.recording.info.world;
  scene.walls = viz::walls_geometry(world);
  scene.roads = viz::roads_geometry(world);
  scene.field = field_grid(world, device, options.height);
  scene.frame = [&](std::size_t row) {
    viz::ScanGeometry beams(true);
    for (const base::ReadingBlock& scan : replay.scans_at(ticks[row])) beams.add(replay.laser(scan), scan);
    return viz::Frame3d{viz::bodies_geometry(world, poses_at(part, ticks[row])), beams.data()};
  };
  const auto first = std::lower_bound(scene.times.begin(), scene.times.end(), options.time - 1e-9);
  scene.first = static_cast<std::size_t>(first - scene.times.begin());
  scene.stop = []() -> bool { return stop_requested(); };
  scene.opened = [] {
    print_message("space plays and pauses, the arrow keys step, the slider chooses the time, q closes the window");
  };
  install_stop_handlers();
  if (options.screenshot.empty()) {
    viz::show_window(scene);
    return 0;
  }
  viz::PixelImage picture;
  viz::show_window(scene, &picture);
  if (stop_requested()) throw Incomplete("interrupted: no picture was written");
  viz::write_png(options.screenshot, picture.rgb, picture.width, picture.height);
  print_message("wrote {}", options.screenshot);
  return 0;
}

}  // namespace sf::apps
