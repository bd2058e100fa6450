#include "vision/follower.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/error.h"
#include "vision/tag_family.h"

namespace sf::vision {

namespace {

constexpr double kSigmas = 4.0;  // of the predicted position

const std::set<std::uint32_t> kNoTags;

double shutter_middle(const Camera& camera) { return 0.5 * (camera.exposure + camera.readout); }

bool is_due(const FollowEvent& event, double time) {
  return event.kind == FollowEvent::Kind::time && time >= event.time;
}

TagPlace place_of_event(const FollowEvent& event, const TagMount& mount) {
  const bool is_flat = mount.fit == TagFreedom::plane;
  return {0.5 * (event.low + event.high), 0.5 * (event.high - event.low), mount.height,
          is_flat ? 0.0 : mount.side + TagDetector::kMaxHeightError};
}

}  // namespace

Follower::Follower(const Testbed& testbed)
    : testbed_(testbed), settings_(*testbed.follow), cells_(family_pattern(testbed.dictionary, 0).cells) {
  check_tags();
  check_event(settings_.start);
  check_event(settings_.stop);
  counts_.cameras.resize(testbed.cameras.size());
  for (const std::uint32_t id : settings_.tags) counts_.tags[id];
  if (settings_.start.watches_tag()) wanted_ = {settings_.start.tag};
}

void Follower::check_tags() const {
  std::set<std::uint32_t> tags = settings_.tags;
  if (tags.empty())
    throw base::InputError(testbed_.file, 0, "[follow] has no tags; expected tags = [7, 9], or --follow 7,9");
  for (const FollowEvent* event : {&settings_.start, &settings_.stop})
    if (event->watches_tag()) tags.insert(event->tag);
  const std::uint32_t size = family_size(testbed_.dictionary);
  for (const std::uint32_t id : tags) {
    if (id >= size)
      throw base::InputError(testbed_.file, 0,
                             fmt::format("tag {} cannot be followed: dictionary '{}' has the ids 0 to {}", id,
                                         testbed_.dictionary, size - 1));
    if (testbed_.only_listed && testbed_.tags.count(id) == 0)
      throw base::InputError(testbed_.file, 0,
                             fmt::format("tag {0} cannot be followed: only_listed ignores it; add a section [[tag]] "
                                         "with id = {0}",
                                         id));
  }
}

void Follower::check_event(const FollowEvent& event) const {
  if (!event.watches_tag()) return;
  Search search;
  for (const TestbedCamera& each : testbed_.cameras)
    add_region(each.camera, place_of_event(event, testbed_.mount(event.tag)), testbed_.mount(event.tag), cells_,
               search);
  if (!search.is_needed())
    throw base::InputError(testbed_.file, event.line,
                           fmt::format("no camera sees the rectangle of \"{}\"; expected x, y, width and height in "
                                       "metres, within the cameras' field of view",
                                       event.text));
}

const std::set<std::uint32_t>& Follower::followed() const { return is_active_ ? settings_.tags : kNoTags; }

const FollowEvent& Follower::awaited() const { return is_active_ ? settings_.stop : settings_.start; }

void Follower::say(double time, std::string text) {
  if (last_message_ && time - *last_message_ < kMessagePeriod) {
    ++unsaid_;
    return;
  }
  last_message_ = time;
  if (unsaid_ > 0) text += fmt::format(" ({} earlier messages left out)", std::exchange(unsaid_, 0));
  messages_.push_back(std::move(text));
}

std::vector<std::string> Follower::messages() { return std::exchange(messages_, {}); }

void Follower::change(bool to_active, double time, const std::string& why, std::span<const TrackedTag> tracked) {
  const FollowEvent& awaited_before = awaited();
  ++(to_active ? counts_.starts : counts_.stops);
  is_active_ = to_active;
  is_over_ = !to_active && !settings_.start.watches_tag();
  wanted_ = followed();
  tracks_.clear();
  was_inside_.reset();
  if (awaited().watches_tag() && !is_over_) {
    wanted_.insert(awaited().tag);
    for (const TrackedTag& tag : tracked)
      if (tag.id == awaited().tag) was_inside_ = awaited().contains({tag.X_WT.x, tag.X_WT.y});
  }
  if (awaited_before.kind == FollowEvent::Kind::none) return;
  say(time, fmt::format("following {} at {:.2f} s{}", to_active ? "starts" : "stops", time, why));
}

bool Follower::starts_by(double time) const {
  return counts_.starts == 0 && (settings_.start.kind == FollowEvent::Kind::none || is_due(settings_.start, time));
}

void Follower::begin(double time) {
  if (starts_by(time)) change(true, time, "", {});
  if (is_over_ || !is_due(settings_.stop, time)) return;
  if (is_active_) change(false, time, "", {});
  is_over_ = true;
  wanted_.clear();
}

bool Follower::is_lost(std::uint32_t id, double time, const Tracker& tracker) const {
  const auto prediction = tracker.predicted(id, time);
  return !prediction || prediction->age > settings_.search;
}

TagPlace Follower::place_of(std::uint32_t id, const Tracker::Prediction& prediction, const Camera& camera) const {
  const TagMount& mount = testbed_.mount(id);
  // The rows of a rolling shutter are exposed earlier or later than the middle one.
  const double blur = shutter_middle(camera) * glm::length(prediction.velocity);
  const double reach = std::min(kSigmas * prediction.sigma, settings_.speed * prediction.age) + blur + settings_.margin;
  const double error = mount.fit == TagFreedom::plane ? 0.0 : mount.side + reach;
  return {prediction.at, glm::dvec2{reach}, prediction.height, error};
}

void Follower::plan(std::span<const double> times, const Tracker& tracker, std::vector<Search>& out) const {
  out.assign(testbed_.cameras.size(), {});
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Camera& camera = testbed_.cameras[i].camera;
    const double time = times[i] + shutter_middle(camera);
    for (const std::uint32_t id : wanted_) {
      if (!is_lost(id, time, tracker)) {
        add_region(camera, place_of(id, *tracker.predicted(id, time), camera), testbed_.mount(id), cells_, out[i]);
        continue;
      }
      const FollowEvent& event = awaited();
      if (event.watches_tag() && event.tag == id)
        add_region(camera, place_of_event(event, testbed_.mount(id)), testbed_.mount(id), cells_, out[i]);
      if (followed().count(id) == 0) continue;
      const auto track = tracks_.find(id);
      if (track == tracks_.end() || !track->second.searched || i == turn_) out[i].whole = true;
    }
    merge_regions(camera.intrinsics, out[i]);
  }
}

void Follower::observe(double time, std::span<const Search> searches, std::span<const std::uint8_t> absent,
                       std::span<const std::vector<Sighting>> sightings, const Tracker& tracker,
                       std::vector<TrackedTag>& tracked) {
  bool all = true;
  for (std::size_t i = 0; i < searches.size(); ++i) all = all && (absent[i] != 0 || searches[i].whole);
  bool turns = false;
  for (const std::uint32_t id : followed()) {
    Track& track = tracks_[id];
    observe_tag(id, time, sightings);
    const bool lost = is_lost(id, time, tracker);
    const bool was_searched = std::exchange(track.searched, lost && (track.searched || all));
    if (track.searched && !was_searched && !track.seen)
      say(time, fmt::format("tag {} is in no camera's image; searching all cameras in turn", id));
    turns = turns || track.searched;
    if (lost && !track.is_lost && track.seen)
      say(time, fmt::format("tag {} was last seen at {:.2f} s; searching all cameras in turn", id, *track.seen));
    track.is_lost = lost;
  }
  if (turns) turn_ = (turn_ + 1) % testbed_.cameras.size();
  react(time, tracked);
  std::erase_if(tracked, [this](const TrackedTag& tag) { return followed().count(tag.id) == 0; });
}

void Follower::observe_tag(std::uint32_t id, double time, std::span<const std::vector<Sighting>> sightings) {
  Track& track = tracks_[id];
  TagUse& use = counts_.tags[id];
  std::optional<std::size_t> best;
  double pixel = 0.0;
  bool is_held = false;
  for (std::size_t i = 0; i < sightings.size(); ++i)
    for (const Sighting& sighting : sightings[i]) {
      if (sighting.id != id) continue;
      is_held = is_held || track.holder == i;
      if (best && sighting.fit.pixel >= pixel) continue;
      best = i, pixel = sighting.fit.pixel;
    }
  if (track.seen) use.longest_gap = std::max(use.longest_gap, time - *track.seen);
  ++(best ? use.seen : use.unseen);
  if (!best) return;
  const auto name = [this](std::size_t camera) { return testbed_.cameras[camera].camera.name; };
  if (!track.holder) {
    say(time, fmt::format("tag {}: found by '{}' at {:.2f} s", id, name(*best), time));
  } else if (!is_held) {
    ++use.hand_overs;
    say(time,
        fmt::format("tag {}: handed over from '{}' to '{}' at {:.2f} s", id, name(*track.holder), name(*best), time));
  }
  if (!is_held) track.holder = best;
  track.seen = time;
}

void Follower::react(double time, std::span<const TrackedTag> tracked) {
  const FollowEvent& event = awaited();
  if (is_over_ || !event.watches_tag()) return;
  for (const TrackedTag& tag : tracked) {
    if (tag.id != event.tag) continue;
    const bool is_inside = event.contains({tag.X_WT.x, tag.X_WT.y});
    const std::optional<bool> before = std::exchange(was_inside_, is_inside);
    const bool happens =
        event.kind == FollowEvent::Kind::enters ? is_inside && before != true : !is_inside && before == true;
    if (happens) change(!is_active_, time, fmt::format(": \"{}\"", event.text), tracked);
    return;
  }
}

void Follower::count(std::size_t camera, const Search& search, bool is_read) {
  CameraUse& use = counts_.cameras[camera];
  const Intrinsics& image = testbed_.cameras[camera].camera.intrinsics;
  ++(search.whole ? use.whole : search.is_needed() ? use.parts : use.asleep);
  use.unread += is_read ? 0 : 1;
  const auto pixels = static_cast<std::uint64_t>(image.width) * static_cast<std::uint64_t>(image.height);
  use.pixels += pixels;
  if (search.whole) use.searched += pixels;
  for (const Region& region : search.regions) use.searched += static_cast<std::uint64_t>(region.area());
}

}  // namespace sf::vision
