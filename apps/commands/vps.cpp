// `vps`: the virtual positioning system.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>

#include "apps/commands/commands.h"
#include "apps/commands/numbered_files.h"
#include "apps/commands/tag_sender.h"
#include "apps/commands/vps_readings.h"
#include "apps/options/camera_inputs.h"
#include "apps/options/peers_option.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/text.h"
#include "apps/reports/vps_report.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "vision/overlay.h"
#include "vision/tag_family.h"
#include "viz/png.h"

namespace sf::apps {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::uint64_t kRenderedImages = 30;  // default limit

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Writes the file of `--track`.
class TrackFile {
 public:
  explicit TrackFile(const std::string& path) : path_(path) {
    if (path.empty()) return;
    file_.open(path);
    file_ << "time_s,tag,x_m,y_m,yaw_rad,vx_m_s,vy_m_s,turn_rad_s,cameras,z_m,z_sigma_m,roll_rad,pitch_rad,"
             "tilt_sigma_rad\n";
  }
  void write(std::span<const vision::TrackedTag> tags) {
    if (path_.empty()) return;
    for (const vision::TrackedTag& t : tags)
      file_ << fmt::format(
          "{:.6f},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n", t.time, t.id,
          t.X_WT.x, t.X_WT.y, t.X_WT.yaw, t.velocity.x, t.velocity.y, t.turn, t.cameras, t.X_WT.z, t.height_sigma,
          t.roll, t.pitch, t.tilt_sigma);
    if (!file_.flush()) throw base::InputError(path_, 0, "cannot be written");
  }

 private:
  std::string path_;
  std::ofstream file_;
};

/// Writes the pictures of `--overlay`.
class Overlay {
 public:
  static constexpr std::uint64_t kMostPictures = 20'000;  ///< per camera, which limits disk usage

  Overlay(const VpsOptions& options, const vision::Testbed& testbed)
      : testbed_(testbed), path_(options.overlay), every_(options.every) {
    if (path_.empty()) return;
    refuse_inputs(options);
    if (std::filesystem::path(path_).extension() == ".avi")
      open_videos();
    else
      for (const vision::TestbedCamera& each : testbed.cameras)
        begin_numbered_files(path_, each.camera.name + "-", ".png");
    if (options.readings > 0)
      readings_.emplace(options.world, netio::Endpoint{netio::resolve(options.bind), options.readings}, testbed);
    if (options.world.empty()) return;
    const world::World world = readings_ ? readings_->world() : world::load_world(options.world);
    for (const vision::TestbedCamera& each : testbed.cameras)
      world_marks_.push_back(vision::world_marks(each.camera, world));
  }

  void write(const vision::Positioning& positioning, std::span<const vision::TrackedTag> tags,
             std::span<const vision::Frame> frames, std::uint64_t number) {
    if (path_.empty() || number % every_ != 0 || pictures_ > kMostPictures) return;
    if (pictures_++ == kMostPictures)
      return print_message("--overlay ends after {} pictures per camera; draw fewer with --every N", kMostPictures);
    const auto lines = readings_ ? readings_->lines(tags) : std::span<const vision::PlaneLine>{};
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (frames[i].image.pixels.empty()) continue;
      const vision::Camera& camera = testbed_.cameras[i].camera;
      std::vector<vision::Mark> marks = world_marks_.empty() ? std::vector<vision::Mark>() : world_marks_[i];
      for (const auto& more : {vision::line_marks(camera, lines), vision::tag_marks(camera, positioning.sightings(i))})
        marks.insert(marks.end(), more.begin(), more.end());
      const vision::Image picture = vision::draw_over(frames[i].image, marks);
      if (!videos_.empty())
        videos_[i]->write(picture);
      else
        viz::write_png(fmt::format("{}/{}-{:06}.png", path_, camera.name, number), picture.pixels, picture.width,
                       picture.height, viz::PngContent::photograph);
    }
  }

 private:
  /// Refuses to write pictures into the folders of the input images.
  void refuse_inputs(const VpsOptions& options) const {
    auto sources = options.inputs;
    if (sources.empty())
      for (const vision::TestbedCamera& each : testbed_.cameras) sources.emplace_back(each.camera.name, each.source);
    for (const auto& [camera, source] : sources)
      if (std::error_code ignored; std::filesystem::equivalent(source, path_, ignored))
        throw base::InputError(path_, 0, "contains the images of camera '" + camera + "'; name another --overlay");
  }
  /// Opens one video per camera: tags.avi, or with several cameras tags-north.avi and so on.
  void open_videos() {
    const std::string stem = path_.substr(0, path_.size() - 4);
    for (const vision::TestbedCamera& each : testbed_.cameras) {
      const std::string file = testbed_.cameras.size() == 1 ? path_ : fmt::format("{}-{}.avi", stem, each.camera.name);
      const vision::Intrinsics& i = each.camera.intrinsics;
      videos_.push_back(vision::opencv().open_video(file, i.width, i.height, std::max(1.0, each.camera.rate / every_)));
    }
  }

  const vision::Testbed& testbed_;
  std::string path_;
  std::uint32_t every_;
  std::uint64_t pictures_ = 0;
  std::vector<std::unique_ptr<vision::VideoFile>> videos_;
  std::optional<SeenReadings> readings_;
  std::vector<std::vector<vision::Mark>> world_marks_;  ///< per camera
};

/// Detects and tracks, and adds times and tags to the report.
std::span<const vision::TrackedTag> process(std::span<const vision::Frame> frames, vision::Positioning& positioning,
                                            VpsReport& report) {
  const Clock::time_point before = Clock::now();
  const double cpu_before = cpu_seconds();
  const auto tags = positioning.update(frames);
  report.processing_s += base::seconds_since(before);
  report.processing_cpu_s += cpu_seconds() - cpu_before;
  for (const vision::TrackedTag& tag : tags) {
    report.tags[tag.id] = tag;
    ++report.reported[tag.id];
  }
  return tags;
}

/// @param robots set to the inputs if they are live robots
std::unique_ptr<CameraInputs> open(const VpsOptions& options, const vision::Testbed& testbed,
                                   const vision::RenderedFleet* fleet, const RobotInputs*& robots) {
  if (fleet != nullptr) return rendered_inputs(testbed, *fleet, options.seed);
  if (options.robots == 0) return open_inputs(testbed, options.inputs);
  const netio::Endpoint listen{netio::resolve(options.bind), options.robots};
  auto inputs = robot_inputs(testbed, listen, options.seed, stop_requested());
  robots = &*inputs;
  print_message("rendering robots that report their true states to {} (robot --truth {}); press Ctrl-C to stop",
                netio::endpoint_text(listen), netio::endpoint_text(listen));
  return inputs;
}

}  // namespace

int vps(const VpsOptions& options) {
  const vision::Testbed testbed = vision::read_testbed(options.testbed);
  TagSender sender(testbed, options.send, peers_of(options, nullptr));
  std::optional<vision::RenderedFleet> fleet;
  std::optional<vision::AccuracyMeter> meter;
  if (options.rendered > 0) {
    fleet.emplace(testbed,
                  vision::FleetOptions{options.rendered, options.speed, options.occluders, true, options.seed});
    meter.emplace(testbed, *fleet);
  }
  const RobotInputs* robots = nullptr;
  const auto inputs = open(options, testbed, fleet ? &*fleet : nullptr, robots);
  vision::Positioning positioning(testbed, 0, inputs->is_live());
  TrackFile track(options.track);
  Overlay overlay(options, testbed);
  install_stop_handlers();
  // Rendering has no end of its own.
  const bool limited = options.images > 0 || options.duration > 0.0 || options.real_time;
  const std::uint64_t most = fleet && !limited ? kRenderedImages : options.images;
  const bool has_end = most > 0 || (!inputs->is_live() && (!fleet || options.duration > 0.0));

  VpsReport report;
  report.cameras = testbed.cameras.size();
  report.orientation = vision::family_orientation(testbed.dictionary);
  std::vector<vision::Frame> frames;
  const std::int64_t epoch = base::unix_time();
  const Clock::time_point start = Clock::now();
  std::uint64_t n = 0;
  bool complete = false;
  for (; !stop_requested() && (most == 0 || n < most) && inputs->next(frames); ++n) {
    complete = options.duration > 0.0 && frames[0].time >= options.duration;
    if (complete) break;
    if (options.real_time && !inputs->is_live()) keep_pace(start, frames[0].time);
    if (stop_requested()) break;
    const auto tags = process(frames, positioning, report);
    for (const std::string& warning : positioning.warnings()) print_message(warning);
    sender.send(tags, epoch);
    track.write(tags);
    overlay.write(positioning, tags, frames, n);
    if (meter) meter->add(frames[0].time, tags);
  }
  report.counts = positioning.counts();
  report.refused = positioning.refused();
  if (meter) report.accuracy = meter->accuracy();
  if (sender.has_addresses()) report.sent = sender.counts();
  report.unaddressed = sender.unaddressed();
  if (robots != nullptr) report.truth = robots->truth();
  print(options.json ? vps_report_json(report) : vps_report_text(report));
  complete = complete || (most > 0 && n >= most);
  if (stop_requested() && has_end && !complete) return interrupted_code();
  return report.counts.sightings > 0 ? 0 : 1;
}

}  // namespace sf::apps
