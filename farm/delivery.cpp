#include "farm/delivery.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/time.h"

namespace sf::farm {

Delivery::Delivery(const sensors::SensorSet& sensor_set, const Faults* faults, const raycast::Episodes& episodes)
    : sensor_set_(sensor_set), faults_(faults), episodes_(episodes) {
  add_sensors();
}

void Delivery::add_sensors() {
  any_ = any_ || (faults_ != nullptr && faults_->delays());
  for (const auto& group : sensor_set_.groups())
    for (const sensors::SensorSpec& row : group.rows) any_ = any_ || base::nanoseconds(row.latency) > 0;
}

std::int64_t Delivery::latency_of(const base::ReadingBlock& block) const {
  return base::nanoseconds(sensor_set_.row(block).latency) + (faults_ != nullptr ? faults_->delay_of(block) : 0);
}

void Delivery::hold(const base::ReadingBlock& block, std::int64_t due) {
  const auto free = std::find_if(waiting_.begin(), waiting_.end(), [](const Waiting& w) { return !w.used; });
  Waiting& place = free != waiting_.end() ? *free : waiting_.emplace_back();
  place.reading.take(block);
  place.due = due;
  place.used = true;
}

bool Delivery::hold_if_late(const base::ReadingBlock& block) {
  const std::int64_t latency = any_ ? latency_of(block) : 0;
  if (latency == 0) return false;
  hold(block, time_of(block));
  next_ = std::min(next_, time_of(block));
  return true;
}

void Delivery::drop(std::uint32_t first, std::uint32_t end) {
  for (Waiting* slot : last_delivered_) slot->used = false;
  last_delivered_.clear();
  next_ = kNever;
  for (Waiting& waiting : waiting_) {
    const std::uint32_t mover = waiting.used ? waiting.reading.block().mover : end;
    if (mover >= first && mover < end) waiting.used = false;
    if (waiting.used) next_ = std::min(next_, waiting.due);
  }
}

std::span<const base::ReadingBlock> Delivery::deliver(std::int64_t now, std::span<const base::ReadingBlock> measured,
                                                      const CopyCalls& calls) {
  if (!any_) return measured;
  for (Waiting* slot : last_delivered_) slot->used = false;
  last_delivered_.clear();
  ready_.clear();
  delivered_.clear();
  for (const base::ReadingBlock& block : measured)
    if (latency_of(block) > 0) hold(block, time_of(block));
  next_ = kNever;
  for (Waiting& w : waiting_) {
    const bool ready = w.used && w.due <= now && calls.has(w.reading.block().mover);
    if (ready) ready_.push_back(&w);
    if (w.used && !ready) next_ = std::min(next_, w.due);
  }
  std::sort(ready_.begin(), ready_.end(), [](const Waiting* p, const Waiting* q) {
    const base::ReadingBlock& a = p->reading.block();
    const base::ReadingBlock& b = q->reading.block();
    return std::tie(p->due, a.mover, a.type, a.sensor, a.sequence) <
           std::tie(q->due, b.mover, b.type, b.sensor, b.sequence);
  });
  for (const Waiting* w : ready_) delivered_.push_back(w->reading.block());
  last_delivered_.swap(ready_);
  for (const base::ReadingBlock& block : measured)
    if (latency_of(block) == 0) delivered_.push_back(block);
  return delivered_;
}

}  // namespace sf::farm
