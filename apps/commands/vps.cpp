// `vps`: the virtual positioning system.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>

#include "apps/commands/commands.h"
#include "apps/commands/tag_sender.h"
#include "apps/commands/vps_pictures.h"
#include "apps/options/camera_inputs.h"
#include "apps/options/peers_option.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/text.h"
#include "apps/reports/vps_report.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "vision/tag_family.h"

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

/// Reads the testbed, with the tags of `--follow`.
vision::Testbed read_testbed(const VpsOptions& options) {
  vision::Testbed testbed = vision::read_testbed(options.testbed);
  if (options.follow == "off") {
    testbed.follow.reset();
  } else if (!options.follow.empty()) {
    if (!testbed.follow) testbed.follow.emplace();
    testbed.follow->tags = vision::read_tags(options.follow);
  }
  return testbed;
}

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
  if (options.robots == 0) return open_inputs(testbed, options.inputs, stop_requested());
  const netio::Endpoint listen{netio::resolve(options.bind), options.robots};
  auto inputs = robot_inputs(testbed, listen, options.seed, stop_requested());
  robots = &*inputs;
  print_message("rendering robots that report their true states to {} (robot --truth {}); press Ctrl-C to stop",
                netio::endpoint_text(listen), netio::endpoint_text(listen));
  return inputs;
}

}  // namespace

int vps(const VpsOptions& options) {
  const vision::Testbed testbed = read_testbed(options);
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
  vision::Follower* const follower = positioning.follower();
  TrackFile track(options.track);
  VpsPictures pictures(options, testbed);
  install_stop_handlers();
  // People watch at the cameras' rate. Rendering has no end of its own.
  const bool real_time = options.real_time || options.view;
  const bool limited = options.images > 0 || options.duration > 0.0 || real_time;
  const std::uint64_t most = fleet && !limited ? kRenderedImages : options.images;
  const bool has_end = most > 0 || (!inputs->is_live() && (!fleet || options.duration > 0.0));

  // Pictures show all images.
  const bool may_skip = options.overlay.empty() && !options.view;
  const auto asleep = [&] { return may_skip ? positioning.asleep() : std::span<const std::uint8_t>(); };

  VpsReport report;
  for (const vision::TestbedCamera& each : testbed.cameras) report.cameras.push_back(each.camera.name);
  report.orientation = vision::family_orientation(testbed.dictionary);
  std::vector<vision::Frame> frames;
  const std::int64_t epoch = base::unix_time();
  const Clock::time_point start = Clock::now();
  std::uint64_t n = 0;
  bool complete = false;
  for (; !stop_requested() && (most == 0 || n < most) && inputs->next(frames, asleep());) {
    complete = options.duration > 0.0 && frames[0].time >= options.duration;
    if (complete) break;
    if (real_time && !inputs->is_live()) keep_pace(start, frames[0].time);
    if (stop_requested()) break;
    if (std::all_of(frames.begin(), frames.end(), [](const vision::Frame& frame) { return frame.missing; })) {
      pictures.skip();
      continue;
    }
    const auto tags = process(frames, positioning, report);
    for (const std::string& warning : positioning.warnings()) print_message(warning);
    if (follower != nullptr)
      for (const std::string& message : follower->messages()) print_message(message);
    sender.send(tags, epoch);
    track.write(tags);
    pictures.show(positioning, tags, frames, n, epoch + static_cast<std::int64_t>(1e9 * frames[0].time));
    if (meter) meter->add(frames[0].time, tags, follower != nullptr ? &follower->followed() : nullptr);
    ++n;
    complete = follower != nullptr && follower->is_over();
    if (complete) break;
  }
  report.counts = positioning.counts();
  if (follower != nullptr) report.follow = follower->counts();
  report.refused = positioning.refused();
  if (meter) report.accuracy = meter->accuracy();
  if (sender.has_addresses()) report.sent = sender.counts();
  report.unaddressed = sender.unaddressed();
  if (robots != nullptr) report.truth = robots->truth();
  print(options.json ? vps_report_json(report) : vps_report_text(report));
  complete = complete || (most > 0 && n >= most);
  if (stop_requested() && has_end && !complete) return interrupted_code();
  const bool found = report.follow ? !report.tags.empty() : report.counts.sightings > 0;
  return found ? 0 : 1;
}

}  // namespace sf::apps
