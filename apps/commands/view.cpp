// `view`: plays a recorded run in the page of the live view.

#include <algorithm>
#include <chrono>
#include <thread>

#include "apps/commands/cloud_replay.h"
#include "apps/commands/commands.h"
#include "apps/commands/field_grid.h"
#include "apps/commands/recorded_video.h"
#include "apps/commands/scan_replay.h"
#include "apps/options/open_device.h"
#include "apps/options/options.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "bridges/viewer.h"
#include "gpu/device.h"
#include "record/recording.h"
#include "scenarios/recorded_states.h"
#include "scenarios/recording_merge.h"
#include "scenarios/replay.h"
#include "scenarios/run_info.h"
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

/// Returns the lights' states at a tick; none if the recording has none.
std::vector<world::LightState> lights_at(const record::Recording& recording, std::size_t tick) {
  std::vector<world::LightState> states;
  if (tick < recording.lights.size())
    for (const base::LightStatus& light : recording.lights[tick].lights)
      states.push_back(static_cast<world::LightState>(light.state));
  return states;
}

int view_3d(const ViewOptions& options) {
  const RecordingPart part = open_part(options.recording, options);
  world::World world = scenarios::recorded_world(part.recording);
  const std::vector<std::size_t> ticks = ticks_apart(part, options.every);
  viz::Scene3d scene;
  scene.times = times_of(part, ticks);
  if (scene.times.empty()) throw base::InputError(part.recording.file, 0, "has no ticks, so there is nothing to show");

  gpu::Device device = open_device(options);
  ScanReplay replay(part, world, device);
  const std::unique_ptr<CloudReplay> clouds = clouds_to_draw(part, world);
  scene.title = "sensorfarm: " + part.recording.info.world;
  scene.walls = viz::walls_geometry(world);
  scene.roads = viz::roads_geometry(world);
  scene.field = field_grid(world, device, options.height);
  scene.frame = [&](std::size_t row) {
    viz::ScanGeometry beams(true);
    for (const base::ReadingBlock& scan : replay.scans_at(ticks[row]))
      beams.add(replay.laser(scan), replay.X_MS(scan), scan);
    return viz::Frame3d{viz::bodies_geometry(world, poses_at(part, ticks[row])), beams.data(),
                        viz::lights_geometry(world, lights_at(part.recording, ticks[row])),
                        clouds ? echoes_of(clouds->at(ticks[row], true)) : viz::PolyData()};
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

using bridges::RunState;

constexpr std::chrono::milliseconds kLook{15};  // interval of polling requests and time
constexpr double kFastest = 1000.0;             // [1] ratio of recorded to real time

/// Plays a recording to users of the bridges, with time control.
class Playback {
 public:
  Playback(scenarios::Replay& replay, scenarios::RecordedShapes& shapes, bridges::Bridge& viewer)
      : replay_(replay), shapes_(shapes), viewer_(viewer), time_(static_cast<double>(replay.start())) {}

  void look() {
    requests_.clear();
    viewer_.take(requests_);
    const bool moved = apply();
    if (!state_.paused) time_ += 1e9 * state_.speed * base::seconds_since(looked_at_);
    looked_at_ = std::chrono::steady_clock::now();
    const auto end = static_cast<double>(replay_.end());
    if (!state_.paused && time_ >= end) state_.paused = true;
    time_ = std::min(time_, end);
    const std::size_t tick = replay_.tick_at(static_cast<std::int64_t>(time_));
    if (shown_ == tick && !moved) return viewer_.publish(state_);
    base::TickRecord record = replay_.tick(tick, moved ? std::nullopt : shown_);
    shapes_.go_to(record.time);
    record.shapes = shapes_.changed();
    viewer_.publish(record, state_);
    shown_ = tick;
  }

 private:
  /// @return true if the time was set
  bool apply() {
    if (requests_.speed) state_.speed = std::min(*requests_.speed, kFastest);
    if (requests_.paused) state_.paused = *requests_.paused;
    const std::size_t last = replay_.ticks() - 1;
    if (requests_.steps > 0) {
      const std::size_t next = std::min(last, shown_.value_or(0) + requests_.steps);
      time_ = static_cast<double>(replay_.time_of(next));
    }
    if (requests_.reset) time_ = static_cast<double>(replay_.start());
    if (requests_.time) time_ = static_cast<double>(*requests_.time);
    return requests_.reset || requests_.time;
  }

  scenarios::Replay& replay_;
  scenarios::RecordedShapes& shapes_;
  bridges::Bridge& viewer_;
  bridges::Requests requests_;
  RunState state_;
  double time_;  ///< [ns] of the recording
  std::optional<std::size_t> shown_;
  std::chrono::steady_clock::time_point looked_at_ = std::chrono::steady_clock::now();
};

int write_frames(const ViewOptions& options) {
  install_stop_handlers();
  RecordingPart part = open_part(options.recording, options);
  write_recorded_video(part, options, options.device);
  return 0;
}

}  // namespace

int view(const ViewOptions& options) {
  if (options.three_d) return view_3d(options);
  if (!options.frames.empty()) return write_frames(options);
  const record::Recording recording = scenarios::open_run(options.recording);
  print_damage(recording);
  world::World world = scenarios::recorded_world(recording);
  scenarios::RecordedShapes shapes(recording, world);
  const sensors::SensorSet sensor_set(world);
  record::Naming naming = record::naming_of(recording.info);
  naming.odometry = record::OdometrySource::truth;  // users can jump to any time
  record::RunInfo info = scenarios::run_info(world, sensor_set,
                                             {.seed = recording.info.seed,
                                              .record_readings = !recording.readings.empty(),
                                              .naming = naming,
                                              .images = {.raw = true}});
  record::name_frames(info);
  info.world = recording.info.world;
  scenarios::Replay replay(recording, info);
  if (replay.left_out() > 0)
    print_message("{} are left out: their sensor types differ in this program, or are missing",
                  counted(replay.left_out(), "reading"));
  bridges::Viewer viewer({world, sensor_set, info, false},
                         {options.port, bridges::ViewerMode::recording, replay.start(), replay.end()});
  install_stop_handlers();
  print_message("{}", viewer.describe());
  for (Playback playback(replay, shapes, viewer); !stop_requested(); std::this_thread::sleep_for(kLook))
    playback.look();
  return 0;
}

}  // namespace sf::apps
