#include "apps/commands/run_video.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "apps/commands/frame_writer.h"
#include "apps/options/robot_names.h"
#include "apps/reports/report.h"
#include "base/displacement.h"
#include "base/echo.h"
#include "base/elementary.h"
#include "base/error.h"
#include "base/tilted_pose.h"
#include "base/time.h"
#include "robots/kinematics.h"
#include "scenarios/experiment.h"
#include "sensors/laser.h"
#include "sensors/laser_modes.h"

namespace sf::apps {

std::vector<std::size_t> rows_of(const world::World& world, const std::vector<std::string>& texts) {
  std::vector<std::string_view> known;
  for (const world::Mover& mover : world.movers) known.push_back(mover.name);
  std::vector<std::size_t> rows;
  for (const std::string& name : robot_names(texts, known)) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) refuse_robot(world, name, known);
    rows.push_back(static_cast<std::size_t>(found - known.begin()));
  }
  return rows;
}

namespace {

viz::RunViewOptions view_options(const world::World& world, const VideoOptions& options) {
  return {.view = {.width = options.video_width, .height = options.video_height, .extent = options.video_extent},
          .followed = rows_of(world, options.video_follow),
          .around = options.video_around,
          .note = options.video_speed == 1.0 ? "" : fmt::format("  (x {:g})", options.video_speed)};
}

/// States of all movers at a tick.
struct Moment {
  std::int64_t time = 0;             ///< [ns]
  std::vector<base::Report> states;  ///< at this time; movers without a state are absent
  std::vector<std::uint8_t> contacts;
  std::vector<world::LightState> lights;
};

/// Marks movers without a state as absent.
void fill_up(std::size_t movers, Moment& moment) {
  moment.states.resize(movers, {.X_WM = base::kAbsent});
  moment.contacts.resize(movers);
}

void store(const base::TickRecord& tick, const std::vector<std::uint8_t>& hidden, std::size_t movers, Moment& to) {
  to.time = tick.time;
  to.states.clear();
  to.contacts.clear();
  fill_up(movers, to);
  for (std::size_t i = 0; i < tick.reports.size(); ++i) {
    const base::Report& report = tick.reports[i];
    if (report.mover < hidden.size() && hidden[report.mover] != 0) continue;
    to.states[report.mover] = report;
    to.states[report.mover].time = tick.time;
    if (i < tick.contacts.size()) to.contacts[report.mover] = tick.contacts[i];
  }
  to.lights.clear();
  for (const base::LightStatus& light : tick.lights) to.lights.push_back(static_cast<world::LightState>(light.state));
}

/// A mover that moved farther than it can drive was teleported. Shows it at its earlier place until then.
base::Pose pose_between(const base::Report& before, const base::Report& after, std::int64_t time) {
  const base::Pose &from = before.X_WM, &to = after.X_WM;
  if (time >= after.time) return to;
  const auto speed = [](const base::Report& state) { return base::hypot(state.velocity.forward, state.velocity.left); };
  const double seconds = 1e-9 * static_cast<double>(after.time - before.time);
  if (base::is_absent(from) || base::is_absent(to) ||
      !base::is_drivable(from, to, std::max(speed(before), speed(after)), seconds))
    return from;
  return robots::interpolate(before, after, time).X_WM;
}

/// Readings of one sensor that are shown.
struct Shown {
  std::size_t mover = 0;
  const record::SensorInfo* sensor = nullptr;
  base::RigidTransform X_MS;                                        ///< of a laser
  std::optional<viz::RangeReading> newest;                          ///< at the time of the last frame
  std::vector<std::pair<std::int64_t, viz::RangeReading>> arrived;  ///< since then, with their times [ns]
};

void bring_up_to(std::int64_t time, Shown& shown) {
  const auto later = std::find_if(shown.arrived.begin(), shown.arrived.end(),
                                  [&](const auto& reading) { return reading.first > time; });
  if (later == shown.arrived.begin()) return;
  shown.newest = std::move((later - 1)->second);
  shown.arrived.erase(shown.arrived.begin(), later);
}

}  // namespace

class RunVideo::Work {
 public:
  Work(const world::World& world, record::RunInfo info, const VideoOptions& options, std::vector<std::uint8_t> hidden)
      : world_(world), info_(std::move(info)), options_(options), hidden_(std::move(hidden)) {
    std::vector<std::size_t> chosen = rows_of(world, options.video_readings);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    choose_sensors(chosen);
    sink_.emplace(options, options.video_width, options.video_height);
    start_writer();
  }

  void add_movers(const world::World& world) {
    writer_->finish();  // its thread reads the world
    writer_.reset();
    world_ = world;
    for (Moment* moment : {&before_, &now_}) fill_up(world_.movers.size(), *moment);
    start_writer();
  }

  void write(const base::TickRecord& tick) {
    std::swap(before_, now_);
    store(tick, hidden_, world_.movers.size(), now_);
    if (!started_) start_ = tick.time, before_ = now_, started_ = true;
    for (const base::ReadingBlock& reading : tick.readings) keep(reading);
    while (frame_time() <= now_.time) add_frame(frame_time());
    for (auto& [key, shown] : shown_) bring_up_to(now_.time, shown);
  }

  VideoFacts finish() {
    if (!started_) {  // stopped before the first tick: players reject files without a frame
      fill_up(world_.movers.size(), now_);
      for (std::size_t m = 0; m < world_.movers.size(); ++m) now_.states[m].X_WM = world_.movers[m].X_WM;
      before_ = now_;
      add_frame(0);
    } else {
      const std::int64_t end = now_.time + base::nanoseconds(info_.interval);
      while (frame_time() < end - 1) add_frame(frame_time());
    }
    writer_->finish();
    return sink_->finish();
  }

 private:
  void start_writer() {
    writer_.emplace(viz::RunView(world_, view_options(world_, options_)),
                    [this](const viz::PixelImage& image) { sink_->add(image); });
  }

  using Key = std::tuple<std::uint32_t, std::uint8_t, std::uint32_t>;  // mover, type, index of the sensor

  void choose_sensors(const std::vector<std::size_t>& movers) {
    const sensors::SensorSet sensor_set(world_);
    for (const std::size_t mover : movers) {
      const std::size_t before = shown_.size();
      std::map<std::uint8_t, std::uint32_t> count;
      base::ReadingBlock laser{.mover = static_cast<std::uint32_t>(mover), .type = sensors::kLaser};
      for (const record::SensorInfo& sensor : info_.movers[mover].sensors) {
        const std::uint32_t number = count[sensor.type]++;
        if (!viz::has_ranges(info_, sensor)) continue;
        Shown& shown = shown_[{laser.mover, sensor.type, number}] = {mover, &sensor, {}, {}, {}};
        laser.sensor = number;
        if (sensor.type == sensors::kLaser) shown.X_MS = sensors::laser_mount(sensor_set, laser);
      }
      if (shown_.size() == before)
        throw base::InputError(
            world_.file, 0,
            fmt::format("'{}' has no laser, sonar or infrared sensor whose readings a video could show",
                        world_.movers[mover].name));
    }
  }

  void keep(const base::ReadingBlock& reading) {
    const auto found = shown_.find({reading.mover, reading.type, reading.sensor});
    if (found == shown_.end()) return;
    viz::RangeReading kept{found->second.sensor, reading.X_WS, {reading.values.begin(), reading.values.end()}};
    if (reading.type == sensors::kLaser) {
      const auto X_WS = compose(base::transform_of(reading.X_WM, reading.tilt), found->second.X_MS);
      const base::TiltedPose pose = base::tilted_pose_of(X_WS);
      if (!base::is_level(pose.tilt)) kept.X_WS = pose.X, kept.tilt = pose.tilt;
    }
    base::mark_too_near(reading.quality, kept.values);
    found->second.arrived.emplace_back(reading.time, std::move(kept));
  }

  /// [ns] Simulated time of the next frame.
  std::int64_t frame_time() const {
    return start_ + base::nanoseconds(static_cast<double>(frames_) * options_.video_speed /
                                      static_cast<double>(options_.video_fps));
  }

  void add_frame(std::int64_t time) {
    viz::RunFrame frame;
    frame.time = 1e-9 * static_cast<double>(time);
    for (std::size_t m = 0; m < world_.movers.size(); ++m)
      frame.X_WM.push_back(pose_between(before_.states[m], now_.states[m], time));
    const Moment& newest = time >= now_.time ? now_ : before_;
    frame.contacts = newest.contacts;
    frame.lights = newest.lights;
    for (auto& [key, shown] : shown_) {
      bring_up_to(time, shown);
      if (shown.newest && !base::is_absent(frame.X_WM[shown.mover])) frame.ranges.push_back(*shown.newest);
    }
    writer_->add(std::move(frame));
    ++frames_;
  }

  world::World world_;  ///< a copy, since the run's world may grow while frames are painted
  const record::RunInfo info_;
  const VideoOptions options_;
  const std::vector<std::uint8_t> hidden_;
  std::map<Key, Shown> shown_;
  Moment before_, now_;  ///< the last two ticks
  bool started_ = false;
  std::int64_t start_ = 0;             ///< [ns] of the first tick
  std::uint64_t frames_ = 0;           ///< so far
  std::optional<FrameSink> sink_;      ///< used by the writer's thread
  std::optional<FrameWriter> writer_;  ///< destroyed before the sink
};

RunVideo::RunVideo(const world::World& world, record::RunInfo info, const VideoOptions& options,
                   std::vector<std::uint8_t> hidden)
    : work_(std::make_unique<Work>(world, std::move(info), options, std::move(hidden))) {}

RunVideo::~RunVideo() = default;

void RunVideo::write(const base::TickRecord& tick) { work_->write(tick); }

void RunVideo::add_movers(const world::World& world) { work_->add_movers(world); }

VideoFacts RunVideo::finish() { return work_->finish(); }

}  // namespace sf::apps
