#include "netio/delay_line.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace sf::netio {

bool DelayLine::later(const QueuedMessage& one, const QueuedMessage& other) {
  return std::tie(one.arrival, one.order) > std::tie(other.arrival, other.order);
}

void DelayLine::send(const MessageId& message, std::int64_t now, std::size_t tag, std::span<const std::uint8_t> bytes) {
  const auto delay = sample_delay(model_, message);
  if (!delay) {
    ++counts_.lost;
    return;
  }
  const MessageFaults faults = sample_faults(model_, message);
  queue(now + *delay, tag, bytes, faults.flipped_bit);
  if (faults.again) queue(now + *faults.again, tag, bytes, faults.flipped_bit);
  counts_.duplicated += faults.again.has_value();
  counts_.corrupted += faults.flipped_bit.has_value();
}

void DelayLine::queue(std::int64_t arrival, std::size_t tag, std::span<const std::uint8_t> bytes,
                      const std::optional<double>& flipped_bit) {
  if (waiting_.size() == kCapacity) {
    ++counts_.full;
    return;
  }
  if (free_.empty()) {
    free_.push_back(memory_.size());
    memory_.emplace_back();
  }
  const std::size_t slot = free_.back();
  free_.pop_back();
  memory_[slot].assign(bytes.begin(), bytes.end());
  if (flipped_bit && !bytes.empty()) {
    const auto bit = static_cast<std::size_t>(*flipped_bit * 8.0 * static_cast<double>(bytes.size()));
    memory_[slot][bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
  }
  waiting_.push_back({arrival, order_++, tag, slot});
  std::push_heap(waiting_.begin(), waiting_.end(), later);
}

/// Returns memory that the next `send` reuses.
DelayLine::QueuedMessage DelayLine::pop() {
  std::pop_heap(waiting_.begin(), waiting_.end(), later);
  const QueuedMessage next = waiting_.back();
  waiting_.pop_back();
  free_.push_back(next.slot);
  return next;
}

std::int64_t DelayLine::next() const {
  return waiting_.empty() ? std::numeric_limits<std::int64_t>::max() : waiting_.front().arrival;
}

}  // namespace sf::netio
