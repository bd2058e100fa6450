#include "server/own_state.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "server/state_filter.h"

namespace sf::server {

namespace {

double square(double v) { return v * v; }

}  // namespace

OwnState::OwnState(const world::Mover& mover, std::uint32_t row, const OwnStateOptions& options)
    : options_(options),
      localization_(sensors::localization_options(mover, options.sensors)),
      clock_(options.cameras ? options.cameras->clock : estimation::ClockOptions{}),
      state_{.mover = row, .X_WM = mover.X_WM} {
  if (options.start) localization_.add_pose(0, *options.start, estimation::kKnownStart);
  if (!options.cameras) return;
  inbox_.emplace(netio::InboxOptions{.bind = options.cameras->bind,
                                     .receive_buffer = std::size_t{1} << 18,
                                     .tags = {options.cameras->tag},
                                     .peers = options.cameras->peers,
                                     .take_late = options.cameras->clock.source != estimation::ClockSource::arrival});
}

void OwnState::receive(std::int64_t now) {
  if (!inbox_) return;
  inbox_->receive(now, [&](const netio::Packet& packet) {
    if (const auto* tag = std::get_if<netio::Tag>(&packet.body))
      take(packet.header, netio::report(packet.header, *tag, 0), now);
  });
}

void OwnState::take(const netio::Header& header, const base::Report& seen, std::int64_t now) {
  using estimation::ClockSource, estimation::ClockVerdict;
  if (++taken_ > kMostBetweenPredictions) {
    ++flooded_;
    return;
  }
  if (header.session != session_) clock_.reset(), tilt_time_ = 0;  // the sender restarted
  session_ = header.session;
  const CameraOptions& cameras = *options_.cameras;
  const std::int64_t epoch = cameras.clock.source == ClockSource::trusted ? epoch_ : 0;
  const ClockVerdict verdict = clock_.take(header.time, now + epoch);
  ++clock_counts_[static_cast<std::size_t>(verdict)];
  if (verdict != ClockVerdict::used && verdict != ClockVerdict::stepped) return;
  if (header.time >= tilt_time_ || verdict == ClockVerdict::stepped) tilt_ = seen.tilt, tilt_time_ = header.time;

  const std::int64_t age =
      cameras.clock.source == ClockSource::arrival ? 0 : clock_.to_sender(now + epoch) - header.time;
  localization_.add_pose(std::max(now - std::max(age, std::int64_t{0}), std::int64_t{0}), seen.X_WM,
                         covariance_of(header));
}

estimation::PoseCovariance OwnState::covariance_of(const netio::Header& header) const {
  const CameraOptions& cameras = *options_.cameras;
  auto stated = estimation::stated_covariance(header.state.covariance);
  if (!stated) {
    const double position = square(cameras.position_sigma);
    return {position, 0.0, 0.0, position, 0.0, square(cameras.yaw_sigma)};
  }
  const base::Twist& v = state_.velocity;
  const double moved = square(cameras.time_sigma) * (square(v.forward) + square(v.left));
  (*stated)[0] += moved;
  (*stated)[3] += moved;
  (*stated)[5] += square(cameras.time_sigma * v.turn);
  return *stated;
}

void OwnState::add_wheels(std::int64_t now, const sensors::Rolled& rolled) {
  localization_.add_encoder(now, rolled.left, rolled.right);
}

void OwnState::add_gyro(std::int64_t now, double rate) { localization_.add_gyro(now, rate); }

void OwnState::add_gps(std::int64_t time, const glm::dvec2& antenna, double hdop, const glm::dvec2& p_MS) {
  const glm::dvec2 p = sensors::origin_of(antenna, localization_.predict(time).estimate.X_WM.yaw, p_MS);
  localization_.add_gps(time, p.x, p.y, hdop);
}

void OwnState::predict(std::int64_t now, double z) {
  taken_ = 0;
  const estimation::Prediction prediction = localization_.predict(now);
  if (prediction.status == estimation::Prediction::Status::none) return;
  const auto& P = prediction.estimate.covariance;
  sigma_ = std::sqrt(P[0] + P[7]);
  const bool unseen = options_.stop_after > 0 && prediction.age > options_.stop_after;
  lost_ = has_wheels() ? !(sigma_ <= options_.most_sigma) : unseen;
  if (lost_) return;
  quality_ = quality_of(prediction);
  state_ = {state_.mover, now, prediction.estimate.X_WM, prediction.estimate.velocity, tilt_};
  state_.X_WM.z = z;
  trail_.add(now, {state_.X_WM, tilt_});
}

OwnStateCounts OwnState::counts() const {
  return {inbox_ ? inbox_->counts() : netio::PacketCounts{}, localization_.counts(), clock_counts_, flooded_};
}

}  // namespace sf::server
