#include "vision/positioning.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/thread_pool.h"

namespace sf::vision {

struct Positioning::State {
  State(const Testbed& of, unsigned threads) : testbed(of), pool(threads), tracker(of.report_from) {}

  const Testbed& testbed;
  base::ThreadPool pool;
  std::vector<TagDetector> detectors;
  std::vector<std::vector<Sighting>> sightings;  ///< per camera
  std::vector<std::uint8_t> is_new;              ///< per camera: its last image was searched
  bool live = false;
  std::vector<std::vector<std::uint8_t>> last;  ///< pixels of each camera's last image, if the cameras are live
  std::uint64_t frozen = 0;
  std::vector<Sighting> all;
  std::vector<TrackedTag> tracked;
  Tracker tracker;
  std::uint64_t repeated = 0;  ///< by the tracker
  std::optional<Follower> follower;
  std::vector<Search> searches;            ///< per camera, if there is a follower
  std::vector<Search> next;                ///< of the next images
  double time = 0.0;                       ///< [s] of the newest images
  std::vector<double> times;               ///< [s] of the newest image of each camera
  std::vector<std::uint8_t> absent;        ///< per camera: no new image
  double period = 0.0;                     ///< [s] between the last two updates
  std::vector<std::uint8_t> asleep;        ///< per camera
  std::map<std::uint32_t, double> warned;  ///< [s] time of the last warning of each id
};

Positioning::Positioning(const Testbed& testbed, unsigned threads, bool live)
    : state_(std::make_unique<State>(testbed, threads)) {
  for (const TestbedCamera& each : testbed.cameras) state_->detectors.emplace_back(testbed, each.camera);
  state_->sightings.resize(testbed.cameras.size());
  state_->last.resize(testbed.cameras.size());
  state_->live = live;
  state_->asleep.resize(testbed.cameras.size());
  if (!testbed.follow) return;
  state_->follower.emplace(testbed);
  state_->times.resize(testbed.cameras.size());
  state_->absent.resize(testbed.cameras.size());
  state_->period = 1.0 / testbed.cameras[0].camera.rate;
}

Positioning::~Positioning() = default;

std::span<const TrackedTag> Positioning::update(std::span<const Frame> frames) {
  State& s = *state_;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Camera& camera = s.testbed.cameras[i].camera;
    const Image& image = frames[i].image;
    if (image.pixels.empty()) continue;
    if (image.width != camera.intrinsics.width || image.height != camera.intrinsics.height)
      throw base::InputError(
          s.testbed.file, 0,
          fmt::format("camera '{}' has size = [{}, {}], but its source provides images of {} x {}; expected the size "
                      "with which it was calibrated",
                      camera.name, camera.intrinsics.width, camera.intrinsics.height, image.width, image.height));
  }
  s.is_new.assign(s.detectors.size(), 0);
  std::vector<std::uint8_t> skipped(frames.size(), 0);  // std::vector<bool> is not safe to share between threads
  for (std::size_t i = 0; i < frames.size(); ++i) {
    skipped[i] = frames[i].missing ? 1 : 0;
    if (!s.live || frames[i].missing || frames[i].unread) continue;
    const std::vector<std::uint8_t>& pixels = frames[i].image.pixels;
    skipped[i] = !pixels.empty() && pixels == s.last[i] ? 1 : 0;  // frozen
    s.frozen += skipped[i];
    s.last[i] = pixels;
  }
  if (s.follower) plan(frames, skipped);
  s.pool.parallel_for(frames.size(), 1, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i)
      if (skipped[i] == 0) {
        if (s.follower)
          s.detectors[i].detect(frames[i].image, frames[i].time, s.searches[i], s.follower->wanted(), s.sightings[i]);
        else
          s.detectors[i].detect(frames[i].image, frames[i].time, s.sightings[i]);
        s.is_new[i] = 1;
      } else {
        s.sightings[i].clear();
      }
  });
  s.all.clear();
  for (const auto& seen : s.sightings) s.all.insert(s.all.end(), seen.begin(), seen.end());
  s.tracker.update(s.all, s.tracked);
  s.repeated += s.tracker.repeated().size();
  if (s.follower) observe();
  return s.tracked;
}

/// Plans the searches of the images, and skips those of cameras that sleep.
void Positioning::plan(std::span<const Frame> frames, std::vector<std::uint8_t>& skipped) {
  State& s = *state_;
  const double before = s.time;
  bool is_first = true;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].missing) continue;
    s.times[i] = frames[i].time;
    if (std::exchange(is_first, false)) s.time = frames[i].time;
  }
  if (s.time > before) s.period = s.time - before;
  s.follower->begin(s.time);
  s.follower->plan(s.times, s.tracker, s.searches);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    s.absent[i] = skipped[i];  // missing or frozen
    if (skipped[i] != 0 || frames[i].unread) s.searches[i] = {};
    if (skipped[i] != 0) continue;
    s.follower->count(i, s.searches[i], !frames[i].unread);
    skipped[i] = s.searches[i].is_needed() ? 0 : 1;
  }
}

/// Lets the follower evaluate the tags, and determines which cameras sleep.
void Positioning::observe() {
  State& s = *state_;
  s.follower->observe(s.time, s.searches, s.absent, s.sightings, s.tracker, s.tracked);
  s.asleep.assign(s.times.size(), s.follower->starts_by(s.time + 2.0 * s.period) ? 0 : 1);
  for (const double periods : {1.0, 2.0}) {
    std::vector<double> times = s.times;
    for (double& time : times) time = std::max(time, s.time) + periods * s.period;
    s.follower->plan(times, s.tracker, s.next);
    for (std::size_t i = 0; i < times.size(); ++i)
      if (s.next[i].is_needed()) s.asleep[i] = 0;
  }
}

Follower* Positioning::follower() { return state_->follower ? &*state_->follower : nullptr; }
std::span<const std::uint8_t> Positioning::asleep() const { return state_->asleep; }

std::span<const Sighting> Positioning::sightings(std::size_t camera) const { return state_->sightings[camera]; }

std::vector<std::string> Positioning::warnings() {
  State& s = *state_;
  std::vector<std::string> texts;
  const auto add = [&](const RepeatedTag& tag, const std::string& where) {
    const auto [last, is_first] = s.warned.try_emplace(tag.id, tag.time);
    if (!is_first && tag.time - last->second < kRepeatPeriod) return;
    last->second = tag.time;
    texts.push_back(fmt::format(
        "tag {} is seen twice {}, at ({:.3f}, {:.3f}) and ({:.3f}, {:.3f}) m; the first is used. Print each "
        "id once, or list the ids in use (only_listed)",
        tag.id, where, tag.at[0].x, tag.at[0].y, tag.at[1].x, tag.at[1].y));
  };
  for (std::size_t i = 0; i < s.detectors.size(); ++i)
    for (const RepeatedTag& tag : s.is_new[i] != 0 ? s.detectors[i].repeated() : std::span<const RepeatedTag>())
      add(tag, fmt::format("in one image of camera '{}'", s.testbed.cameras[i].camera.name));
  for (const RepeatedTag& tag : s.tracker.repeated()) add(tag, "by two cameras at one time");
  return texts;
}

DetectionCounts Positioning::counts() const {
  DetectionCounts sum;
  for (const TagDetector& detector : state_->detectors) {
    const DetectionCounts& c = detector.counts();
    sum.images += c.images;
    sum.unreadable += c.unreadable;
    sum.sightings += c.sightings;
    sum.unwanted += c.unwanted;
    sum.unlisted += c.unlisted;
    sum.unfitted += c.unfitted;
    sum.misfitted += c.misfitted;
    sum.repeated += c.repeated;
  }
  sum.repeated += state_->repeated;
  sum.images += state_->frozen;
  sum.frozen = state_->frozen;
  if (!state_->follower) return sum;
  for (const CameraUse& use : state_->follower->counts().cameras) sum.asleep += use.asleep;
  sum.images += sum.asleep;
  return sum;
}

std::uint64_t Positioning::refused() const { return state_->tracker.refused(); }

}  // namespace sf::vision
