#include "vision/tracker.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::vision {

namespace {

constexpr double kAcceleration = 2.0;       // [m/s2/sqrt(Hz)] white acceleration of the tags
constexpr double kTurnAcceleration = 10.0;  // [rad/s2/sqrt(Hz)]
constexpr double kPositionSigma = 0.05;     // [px] of a measured position
constexpr double kHeadingSigma = 2e-3;      // [rad] of a measured heading
constexpr double kGate = 0.3;      // [m] beyond the distance that the speed allows: another tag, or a false one
constexpr double kMaxSpeed = 5.0;  // [m/s]
constexpr double kForget = 1.0;    // [s] without a sighting, after which tracking of a tag restarts

}  // namespace

void Tracker::predict(Axis& axis, double dt, double acceleration) {
  const double q = acceleration * acceleration * dt;  // variance of the velocity added during an interval
  axis.x += dt * axis.v;
  axis.xx += dt * (2.0 * axis.xv + dt * axis.vv) + q * dt * dt / 3.0;
  axis.xv += dt * axis.vv + q * dt / 2.0;
  axis.vv += q;
}

void Tracker::correct(Axis& axis, double measured, double sigma) {
  const double gain = 1.0 / (axis.xx + sigma * sigma);
  const double kx = axis.xx * gain, kv = axis.xv * gain;
  const double error = measured - axis.x;
  axis.x += kx * error;
  axis.v += kv * error;
  axis.vv -= kv * axis.xv;
  axis.xv *= 1.0 - kx;
  axis.xx *= 1.0 - kx;
}

/// Merges the views of one tag at one time: at the time of the first, weighted by 1 / pixel^2. Rejects views at another
/// position than the first, or, for a known tag, the first near its track.
std::optional<Tracker::View> Tracker::merge(const Track* track, std::span<const Sighting> views, int& used) {
  const auto view_of = [](const Sighting& s) {
    return View{s.time, s.fit.pixel, {s.fit.X_WT.x, s.fit.X_WT.y, s.fit.X_WT.yaw}, &s.fit};
  };
  const auto fits = [track](const View& view) { return track == nullptr || is_near(*track, view); };
  const auto found = std::find_if(views.begin(), views.end(), [&](const Sighting& s) { return fits(view_of(s)); });
  used = 0;
  if (found == views.end()) return std::nullopt;
  const View first = view_of(*found);
  View sum{first.time, 0.0, {}, first.fit};
  bool is_repeated = false;
  double weights = 0.0;
  for (const Sighting& sighting : views) {
    const View view = view_of(sighting);
    const double dt = first.time - view.time;
    const double apart = base::hypot(view.at[0] - first.at[0], view.at[1] - first.at[1]);
    if (apart > 0.5 * kGate + kMaxSpeed * std::abs(dt)) {
      if (!is_repeated)
        repeated_.push_back(
            {sighting.id, first.time, {glm::dvec2{first.at[0], first.at[1]}, glm::dvec2{view.at[0], view.at[1]}}});
      is_repeated = true;
      continue;
    }
    if (!fits(view)) continue;
    if (view.fit->height_sigma < sum.fit->height_sigma) sum.fit = view.fit;
    const double weight = 1.0 / (view.pixel * view.pixel);
    for (std::size_t i = 0; i < 3; ++i) {
      // Averages headings relative to the first, which avoids the jump at pi.
      const double off = i == 2 ? base::wrap_angle(view.at[2] - first.at[2]) : view.at[i] - first.at[i];
      sum.at[i] += weight * (off + (track != nullptr ? dt * track->axes[i].v : 0.0));
    }
    weights += weight;
    ++used;
  }
  for (std::size_t i = 0; i < 3; ++i) sum.at[i] = first.at[i] + sum.at[i] / weights;
  sum.pixel = 1.0 / std::sqrt(weights);
  return sum;
}

bool Tracker::is_near(const Track& track, const View& view) {
  const double dt = view.time - track.time;
  const double apart = base::hypot(view.at[0] - track.axes[0].x, view.at[1] - track.axes[1].x);
  return dt > 0.0 && apart <= kGate + kMaxSpeed * dt;
}

void Tracker::advance(Track& track, const View& view) {
  const double dt = view.time - track.time;
  const double turned = base::wrap_angle(view.at[2] - track.yaw);
  const auto turn_velocity = [&track](double angle) {
    const glm::dvec2 v = base::rotate(angle, {track.axes[0].v, track.axes[1].v});
    track.axes[0].v = v.x;
    track.axes[1].v = v.y;
  };
  track.time = view.time;
  track.yaw = view.at[2];
  turn_velocity(0.5 * turned);
  for (std::size_t i = 0; i < 3; ++i) {
    Axis& axis = track.axes[i];
    predict(axis, dt, i == 2 ? kTurnAcceleration : kAcceleration);
  }
  turn_velocity(0.5 * turned);
  for (std::size_t i = 0; i < 3; ++i) {
    Axis& axis = track.axes[i];
    const double measured = i == 2 ? axis.x + base::wrap_angle(view.at[2] - axis.x) : view.at[i];
    correct(axis, measured, i == 2 ? kHeadingSigma : kPositionSigma * view.pixel);
  }
}

std::optional<Tracker::Prediction> Tracker::predicted(std::uint32_t id, double time) const {
  const auto found = tracks_.find(id);
  if (found == tracks_.end()) return std::nullopt;
  const Track& track = found->second;
  const double age = std::max(0.0, time - track.time);
  std::array<Axis, 2> axes{track.axes[0], track.axes[1]};
  for (Axis& axis : axes) predict(axis, age, kAcceleration);
  return Prediction{{axes[0].x, axes[1].x},
                    {axes[0].v, axes[1].v},
                    track.height,
                    std::sqrt(std::max({0.0, axes[0].xx, axes[1].xx})),
                    age};
}

void Tracker::update(std::span<const Sighting> sightings, std::vector<TrackedTag>& out) {
  out.clear();
  repeated_.clear();
  sorted_.assign(sightings.begin(), sightings.end());
  std::stable_sort(sorted_.begin(), sorted_.end(), [](const Sighting& a, const Sighting& b) { return a.id < b.id; });
  for (std::size_t begin = 0, end = 0; begin < sorted_.size(); begin = end) {
    const std::uint32_t id = sorted_[begin].id;
    while (end < sorted_.size() && sorted_[end].id == id) ++end;
    const std::span<const Sighting> views(sorted_.data() + begin, end - begin);

    auto found = tracks_.find(id);
    if (found != tracks_.end() && views[0].time - found->second.time > kForget)
      found = (tracks_.erase(found), tracks_.end());
    int used = 0;
    const auto view = merge(found == tracks_.end() ? nullptr : &found->second, views, used);
    refused_ += views.size() - static_cast<std::size_t>(used);
    if (!view) continue;

    if (found == tracks_.end()) {
      Track track{view->time, view->at[2], {}, 1};
      for (std::size_t i = 0; i < 3; ++i) {
        const double sigma = i == 2 ? kHeadingSigma : kPositionSigma * view->pixel;
        const double speed = i == 2 ? 2.0 * M_PI : kMaxSpeed;
        track.axes[i] = {view->at[i], 0.0, sigma * sigma, 0.0, speed * speed};
      }
      found = tracks_.emplace(id, track).first;
    } else {
      advance(found->second, *view);
      found->second.seen = std::min(found->second.seen + 1, report_from_);
    }
    Track& track = found->second;
    track.height = view->fit->X_WT.z;
    if (track.seen < report_from_) continue;
    out.push_back({id,
                   view->time,
                   {view->at[0], view->at[1], view->fit->X_WT.z, base::wrap_angle(view->at[2])},
                   {track.axes[0].v, track.axes[1].v},
                   track.axes[2].v,
                   used,
                   view->fit->height_sigma,
                   view->fit->roll,
                   view->fit->pitch,
                   view->fit->tilt_sigma,
                   kPositionSigma * view->pixel,
                   kHeadingSigma});
  }
}

}  // namespace sf::vision
