#include "robots/estimation/sender_clock.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sf::estimation {

namespace {

/// A point relative to the newest timestamp and its offset. The numbers are small, so doubles hold them exactly.
struct HullPoint {
  double sent = 0.0;  ///< [ns] <= 0
  double gap = 0.0;   ///< [ns]
};

/// Differences of gaps may exceed 64 bits. Doubles are precise enough to compare them with limits of seconds.
double difference(std::int64_t a, std::int64_t b) { return static_cast<double>(a) - static_cast<double>(b); }

double slope(const HullPoint& a, const HullPoint& b) { return (b.gap - a.gap) / (b.sent - a.sent); }

/// Andrew's monotone chain: leaves the lower convex hull at the front.
/// @param points sorted by `sent`, without duplicates
/// @return number of points of the hull
std::size_t lower_hull(HullPoint* points, std::size_t count) {
  std::size_t hull = 0;
  for (std::size_t k = 0; k < count; ++k) {
    while (hull >= 2 && slope(points[hull - 2], points[hull - 1]) >= slope(points[hull - 2], points[k])) --hull;
    points[hull++] = points[k];
  }
  return hull;
}

}  // namespace

std::string_view name(ClockVerdict verdict) {
  constexpr std::array<std::string_view, 4> kNames{"used", "stepped", "future", "late"};
  return kNames[static_cast<std::size_t>(verdict)];
}

ClockVerdict SenderClock::take(std::int64_t sent, std::int64_t arrival) {
  if (options_.source == ClockSource::arrival) return ClockVerdict::used;
  const std::int64_t gap = arrival - sent;
  if (options_.source == ClockSource::trusted) {
    if (gap < -options_.max_future) return ClockVerdict::future;
    return gap > options_.max_delay ? ClockVerdict::late : ClockVerdict::used;
  }
  if (!state_.synchronised) {
    begin(sent, gap);
    return ClockVerdict::used;
  }

  // In excess of the least delay.
  const double delay = difference(gap - options_.least_delay, state_.offset) - state_.drift * difference(sent, newest_);
  const ClockVerdict verdict = delay < -static_cast<double>(options_.max_future) ? ClockVerdict::future
                               : delay > static_cast<double>(options_.max_delay) ? ClockVerdict::late
                                                                                 : ClockVerdict::used;
  if (verdict != ClockVerdict::used) {
    if (!confirms_step(verdict, gap)) return verdict;
    begin(sent, gap);
    ++state_.steps;
    return ClockVerdict::stepped;
  }
  refusals_ = 0;
  if (add(sent, gap)) fit();
  return ClockVerdict::used;
}

/// After a clock was reset, every packet shows the same new gap.
bool SenderClock::confirms_step(ClockVerdict refusal, std::int64_t gap) {
  const bool agrees = refusals_ > 0 && refusal == refusal_ &&
                      std::abs(difference(gap, refused_gap_)) <= static_cast<double>(options_.max_future);
  refusals_ = agrees ? refusals_ + 1 : 1;
  if (!agrees) refused_gap_ = gap;
  refusal_ = refusal;
  return refusals_ >= kConfirmations;
}

void SenderClock::begin(std::int64_t sent, std::int64_t gap) {
  points_ = {};
  refusals_ = 0;
  newest_ = sent;
  state_ = {.offset = gap - options_.least_delay, .synchronised = true, .steps = state_.steps};
  add(sent, gap);
}

/// @return whether the window changed
bool SenderClock::add(std::int64_t sent, std::int64_t gap) {
  const std::int64_t slot = sent / kSlot;
  if (slot <= newest_ / kSlot - kSlots) return false;
  Point& point = points_[static_cast<std::size_t>(slot % kSlots)];
  const bool taken = point.set && point.sent / kSlot == slot;
  const bool better = !taken || gap < point.gap || (gap == point.gap && sent < point.sent);
  if (better) point = {true, sent, gap};
  if (sent > newest_) {
    state_.offset += std::llround(state_.drift * static_cast<double>(sent - newest_));
    newest_ = sent;
  }
  return better;
}

/// Fits the line of Moon et al. to the points of the window.
void SenderClock::fit() {
  std::array<HullPoint, kSlots> points;
  std::size_t count = 0;
  const std::int64_t last = newest_ / kSlot;
  for (std::int64_t slot = std::max<std::int64_t>(0, last - kSlots + 1); slot <= last; ++slot) {
    const Point& point = points_[static_cast<std::size_t>(slot % kSlots)];
    if (point.set && point.sent / kSlot == slot)
      points[count++] = {static_cast<double>(point.sent - newest_), static_cast<double>(point.gap - state_.offset)};
  }
  if (count == 0) return;
  const double first = points[0].sent;
  const double span = points[count - 1].sent - first;
  state_.drift_known = span >= static_cast<double>(kDriftSpan);

  double drift = 0.0;
  if (state_.drift_known) {
    const double middle = first + 0.5 * span;
    std::array<HullPoint, kSlots> hull = points;
    const std::size_t size = lower_hull(hull.data(), count);
    std::size_t right = 1;
    while (right + 1 < size && hull[right].sent < middle) ++right;
    drift = std::clamp(slope(hull[right - 1], hull[right]), -kMaxDrift, kMaxDrift);
  }
  // The highest line with this slope below all points, at the newest timestamp.
  double least = HUGE_VAL;
  for (std::size_t k = 0; k < count; ++k) least = std::min(least, points[k].gap - drift * points[k].sent);
  state_.drift = drift;
  state_.offset += std::llround(least) - options_.least_delay;
}

std::int64_t SenderClock::to_sender(std::int64_t own) const {
  if (options_.source != ClockSource::estimated) return own;
  const std::int64_t since = own - state_.offset - newest_;
  return newest_ + std::llround(static_cast<double>(since) / (1.0 + state_.drift));
}

void SenderClock::reset() {
  points_ = {};
  refusals_ = 0;
  newest_ = 0;
  state_ = {.steps = state_.steps};
}

}  // namespace sf::estimation
