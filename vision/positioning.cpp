#include "vision/positioning.h"

#include <fmt/format.h>

#include <map>

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
  std::uint64_t repeated = 0;              ///< by the tracker
  std::map<std::uint32_t, double> warned;  ///< [s] time of the last warning of each id
};

Positioning::Positioning(const Testbed& testbed, unsigned threads, bool live)
    : state_(std::make_unique<State>(testbed, threads)) {
  for (const TestbedCamera& each : testbed.cameras) state_->detectors.emplace_back(testbed, each.camera);
  state_->sightings.resize(testbed.cameras.size());
  state_->last.resize(testbed.cameras.size());
  state_->live = live;
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
    if (!s.live || frames[i].missing) continue;
    const std::vector<std::uint8_t>& pixels = frames[i].image.pixels;
    skipped[i] = !pixels.empty() && pixels == s.last[i] ? 1 : 0;  // frozen
    s.frozen += skipped[i];
    s.last[i] = pixels;
  }
  s.pool.parallel_for(frames.size(), 1, [&](std::size_t first, std::size_t last, unsigned) {
    for (std::size_t i = first; i < last; ++i)
      if (skipped[i] == 0) {
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
  return s.tracked;
}

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
    sum.unlisted += c.unlisted;
    sum.unfitted += c.unfitted;
    sum.misfitted += c.misfitted;
    sum.repeated += c.repeated;
  }
  sum.repeated += state_->repeated;
  sum.images += state_->frozen;
  sum.frozen = state_->frozen;
  return sum;
}

std::uint64_t Positioning::refused() const { return state_->tracker.refused(); }

}  // namespace sf::vision
