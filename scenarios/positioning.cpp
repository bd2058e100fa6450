#include "scenarios/positioning.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "base/error.h"
#include "base/random.h"
#include "base/time.h"
#include "farm/schedule.h"
#include "netio/packets.h"

namespace sf::scenarios {

namespace {

constexpr auto kPoses = static_cast<std::uint32_t>(netio::Type::tag) << 16;

double stated_variance(double stated, double noise) {
  const double sigma = stated > 0.0 ? stated : std::max(noise, 1e-3);
  return sigma * sigma;
}

}  // namespace

Positioning::Positioning(const PositioningOptions& options, std::uint32_t robot) : options_(options), robot_(robot) {
  const double latest = options.link.delay + options.link.jitter;
  if (latest > kLatest)
    throw base::InputError(
        fmt::format("[positioning] delivers poses up to {:g} s late, but robots use none that are "
                    "older than {:g} s; choose a shorter delay or jitter",
                    latest, kLatest));
  covariance_[0] = covariance_[3] = stated_variance(options.stated_position_sigma, options.position_sigma);
  covariance_[5] = stated_variance(options.stated_yaw_sigma, options.yaw_sigma);
}

void Positioning::measure(std::int64_t time, const base::Pose& X_WM) {
  const std::uint64_t started = farm::readings_started(time, options_.rate, 0.0);
  if (started <= measured_) return;
  measured_ = started;
  const double now = 1e-9 * static_cast<double>(time);
  const auto covers = [&](const PositioningOptions::Outage& o) { return now >= o.begin && now < o.end; };
  if (std::any_of(options_.outages.begin(), options_.outages.end(), covers)) return;
  const auto delay = netio::sample_delay(options_.link, {robot_, kPoses, started});
  if (!delay) return;
  const base::RandomKey draw{options_.link.seed, base::RandomStream::link, robot_, kPoses + 1, started};
  const auto along = base::random_normal(draw, 0), turned = base::random_normal(draw, 1);
  base::Pose measured = X_WM;
  measured.x += options_.position_sigma * along[0];
  measured.y += options_.position_sigma * along[1];
  measured.yaw = base::wrap_angle(X_WM.yaw + options_.yaw_sigma * turned[0]);
  coming_.push_back({time + *delay, {time, measured, covariance_}});
}

std::span<const control::MeasuredPose> Positioning::receive(std::int64_t now) {
  std::sort(coming_.begin(), coming_.end(), [](const Message& a, const Message& b) {
    return std::tuple(a.arrival, a.pose.time) < std::tuple(b.arrival, b.pose.time);
  });
  const auto arrived = std::find_if(coming_.begin(), coming_.end(), [&](const Message& m) { return m.arrival > now; });
  arrived_.clear();
  std::for_each(coming_.begin(), arrived, [&](const Message& m) { arrived_.push_back(m.pose); });
  coming_.erase(coming_.begin(), arrived);
  return arrived_;
}

}  // namespace sf::scenarios
