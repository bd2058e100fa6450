#include "apps/commands/recorded_video.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "apps/commands/camera_video.h"
#include "apps/commands/scan_replay.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "gpu/device.h"
#include "scenarios/recorded_states.h"
#include "scenarios/replay.h"
#include "scenarios/run_info.h"

namespace sf::apps {

namespace {

/// Recomputes the scans of the shown robots at the last tick before each frame.
class MissingScans {
 public:
  MissingScans(const RecordingPart& part, world::World& world, const VideoOptions& options, const std::string& device)
      : device_(device),
        replay_(part, world, device_),
        ticks_(
            ticks_apart(part, std::max(0.0, options.video_speed / options.video_fps - part.recording.info.interval))) {}

  void add_to(base::TickRecord& tick, std::size_t number) {
    if (!std::binary_search(ticks_.begin(), ticks_.end(), number)) return;
    tick.readings = replay_.scans_at(number);
  }

 private:
  gpu::Device device_;
  ScanReplay replay_;
  std::vector<std::size_t> ticks_;
};

}  // namespace

void write_recorded_video(RecordingPart& part, const VideoOptions& options, const std::string& device) {
  if (!options.video_camera.empty()) return write_camera_video(part, options);
  const record::Recording& recording = part.recording;
  world::World world = scenarios::recorded_world(recording);
  scenarios::RecordedShapes shapes(recording, world);
  const record::RunInfo info =
      scenarios::run_info(world, sensors::SensorSet(world), {.seed = recording.info.seed, .record_readings = true});
  std::vector<std::uint8_t> hidden;
  for (const std::uint8_t chosen : part.chosen) hidden.push_back(chosen == 0);
  RunVideo video(world, info, options, hidden);
  scenarios::Replay replay(recording, info);
  std::optional<MissingScans> scans;
  if (recording.readings.empty() && !options.video_readings.empty()) {
    part.chosen.assign(part.chosen.size(), 0);
    for (const std::size_t row : rows_of(world, options.video_readings)) part.chosen[row] = 1;
    if (has_laser(part, world)) scans.emplace(part, world, options, device);
  }
  {
    Progress progress(options.frames.empty() ? "encoding" : "painting");
    for (std::size_t i = 0; i < replay.ticks() && (i == 0 || !stop_requested()); ++i) {
      base::TickRecord tick = replay.tick(i, i == 0 ? std::nullopt : std::optional(i - 1));
      shapes.go_to(tick.time);
      if (!shapes.changed().empty()) video.add_movers(world);
      if (scans) scans->add_to(tick, i);
      video.write(tick);
      progress.show(static_cast<double>(i) / static_cast<double>(replay.ticks()));
    }
  }
  const VideoFacts facts = video.finish();
  print_message("wrote {}: {}", facts.file, video_text(facts));
  heed_stop(options.frames.empty() ? "interrupted: the video ends early but can be played"
                                   : "interrupted: the frames end early");
}

}  // namespace sf::apps
