#include "server/state_filter.h"

#include <cmath>

namespace sf::server {

namespace {

/// Cars and wheeled robots drive on arcs; a tag may be on anything.
estimation::MotionModel motion_model(const world::Mover& mover) {
  if (mover.is_tag) return estimation::free_body();
  estimation::MotionModel model = estimation::differential_drive();
  if (mover.drive == world::Drive::omni) model.left = model.forward;
  return model;
}

}  // namespace

StateFilter::StateFilter(const world::World& world, const StateFilterOptions& options)
    : world_(world), options_(options), movers_(options.mode == FilterMode::off ? 0 : world.movers.size()) {
  for (std::uint32_t row = 0; row < movers_.size(); ++row) reset(row);
  reports_.reserve(movers_.size());
}

void StateFilter::add_mover() {
  if (options_.mode == FilterMode::off) return;
  movers_.emplace_back();
  reset(static_cast<std::uint32_t>(movers_.size() - 1));
}

void StateFilter::reset(std::uint32_t row) {
  if (options_.mode == FilterMode::off) return;
  MoverState& mover = movers_[row] = MoverState();
  mover.clock = estimation::SenderClock(options_.clock);
  mover.filtered = options_.mode == FilterMode::on;
}

bool StateFilter::take(const base::Report& report, const netio::Header& header, std::int64_t now) {
  using estimation::ClockSource, estimation::ClockVerdict;
  if (options_.mode == FilterMode::off) return false;
  MoverState& mover = movers_[report.mover];
  if (++mover.taken > kMostBetweenPredictions) {
    if (mover.filtered) ++flooded_;
    return mover.filtered;
  }
  if (!mover.track)
    mover.track.emplace(estimation::FilterOptions{.model = motion_model(world_.movers[report.mover]),
                                                  .stale_after = options_.stale_after,
                                                  .max_future = options_.clock.max_future,
                                                  .hypotheses = options_.hypotheses},
                        gate_limits_);
  if (header.session != mover.session) forget(mover);  // the sender restarted
  mover.session = header.session;

  const ClockVerdict verdict = mover.clock.take(header.time, now + epoch());
  if (verdict == ClockVerdict::stepped) forget_times(mover);
  if (options_.mode == FilterMode::automatic) mover.filtered = is_late(mover, header, now);
  if (!mover.filtered) return false;
  used_ = true;
  ++clock_counts_[static_cast<std::size_t>(verdict)];
  if (verdict != ClockVerdict::used && verdict != ClockVerdict::stepped) return true;

  // The track's times are on the sender's clock, so a changed clock estimate moves no measurement.
  const std::int64_t sender_now = sender_time(mover, now);
  estimation::Measurement m = measurement(report, header);
  m.time = options_.clock.source == ClockSource::arrival ? now : header.time;
  const estimation::Verdict used = mover.track->take(m, sender_now);
  const bool restarted = used == estimation::Verdict::started;
  if (restarted || (used == estimation::Verdict::used && m.time >= mover.tilt_time))
    mover.tilt = report.tilt, mover.tilt_time = m.time;
  return true;
}

/// Returns whether the sender is to be filtered from this state on.
bool StateFilter::is_late(MoverState& mover, const netio::Header& header, std::int64_t now) {
  mover.arrivals.take(header.time, now);
  const bool late = mover.arrivals.is_late(now);
  if (late == mover.filtered) return late;
  mover.track->reset();
  mover.gone = false;
  mover.quality = {};
  mover.synchronised = late && is_synchronised(mover);
  return late;
}

/// Clocks that nothing synchronises rarely differ by less than the delays of a link vary. A smaller difference from
/// Unix time is therefore taken as the least delay of the link.
bool StateFilter::is_synchronised(const MoverState& mover) const {
  if (!options_.unix_time || options_.clock.source != estimation::ClockSource::estimated) return false;
  const std::int64_t least = mover.arrivals.least_gap() + options_.epoch;
  return 0 <= least && least <= mover.arrivals.spread();
}

std::int64_t StateFilter::sender_time(const MoverState& mover, std::int64_t now) const {
  return mover.synchronised ? now + options_.epoch : mover.clock.to_sender(now + epoch());
}

estimation::Measurement StateFilter::measurement(const base::Report& report, const netio::Header& header) const {
  const auto square = [](double sigma) { return sigma * sigma; };
  const double position = square(options_.position_sigma);
  const double speed = square(options_.speed_sigma);
  estimation::Measurement m{.sequence = header.sequence, .X_WM = report.X_WM, .velocity = report.velocity};
  m.pose_covariance = {position, 0.0, 0.0, position, 0.0, square(options_.yaw_sigma)};
  if (const auto stated = estimation::stated_covariance(header.state.covariance)) {
    m.pose_covariance = *stated;
    const world::Mover& mover = world_.movers[report.mover];
    if (mover.is_tag)
      m.pose_covariance = estimation::moved(*stated, base::rotate(report.X_WM.yaw, {-mover.X_MT.x, -mover.X_MT.y}));
  }
  m.twist_variance = {speed, speed, square(options_.turn_sigma)};
  // Cameras that do not measure velocities send zeros.
  const base::Twist& v = report.velocity;
  if (world_.movers[report.mover].is_tag && v.forward == 0.0 && v.left == 0.0 && v.turn == 0.0)
    m.components = estimation::kPoseBits;
  return m;
}

const std::vector<base::Report>& StateFilter::predict(std::int64_t now) {
  using Status = estimation::Prediction::Status;
  reports_.clear();
  for (std::uint32_t row = 0; row < movers_.size(); ++row) {
    MoverState& mover = movers_[row];
    mover.taken = 0;
    if (!mover.track || !mover.filtered) continue;
    const estimation::Prediction prediction = mover.track->predict(sender_time(mover, now));
    if (prediction.status == Status::none) continue;
    const bool stale = prediction.status == Status::stale;
    mover.quality = quality_of(prediction);
    mover.gone = stale && options_.policy != estimation::StalePolicy::freeze;
    reports_.push_back({row, now, prediction.estimate.X_WM, prediction.estimate.velocity, mover.tilt});
    if (stale && options_.policy == estimation::StalePolicy::drop) forget(mover);
  }
  return reports_;
}

std::int64_t StateFilter::epoch() const {
  return options_.clock.source == estimation::ClockSource::trusted ? options_.epoch : 0;
}

void StateFilter::forget(MoverState& mover) {
  forget_times(mover);
  mover.clock.reset();
}

/// Drops everything that depends on the sender's timestamps, except the estimate of its clock.
void StateFilter::forget_times(MoverState& mover) {
  mover.track->reset();
  mover.arrivals.reset();
  mover.synchronised = false;
}

StateFilterCounts StateFilter::counts() const {
  StateFilterCounts counts{.clocks = clock_counts_, .flooded = flooded_};
  for (const MoverState& mover : movers_)
    for (std::size_t k = 0; mover.track && k < estimation::kVerdicts; ++k) counts.states[k] += mover.track->counts()[k];
  return counts;
}

std::vector<SenderClockState> StateFilter::clocks() const {
  std::vector<SenderClockState> clocks;
  for (std::uint32_t row = 0; row < movers_.size(); ++row)
    if (movers_[row].filtered && movers_[row].clock.state().synchronised)
      clocks.push_back({row, movers_[row].clock.state()});
  return clocks;
}

}  // namespace sf::server
