#pragma once
// Simulated network delay and loss: messages are queued until their arrival, or dropped.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "netio/link_model.h"

namespace sf::netio {

struct DelayCounts {
  std::uint64_t passed = 0;      ///< released
  std::uint64_t lost = 0;        ///< lost according to the model
  std::uint64_t full = 0;        ///< dropped because the queue held kCapacity messages
  std::uint64_t duplicated = 0;  ///< second copies, also included in the other counts
  std::uint64_t corrupted = 0;   ///< messages with a flipped bit, in all of their copies
};

/// Single-threaded. Reuses the memory of messages.
class DelayLine {
 public:
  static constexpr std::size_t kCapacity = 65'536;

  explicit DelayLine(const LinkModel& model) : model_(model) {}

  /// Queues a copy of a message sent at `now` [ns], with the faults of the model, or drops it.
  /// @param tag passed on to `take`
  void send(const MessageId& message, std::int64_t now, std::size_t tag, std::span<const std::uint8_t> bytes);

  /// Passes all messages that have arrived by `now` [ns] to `take(std::size_t tag, std::span<const std::uint8_t>
  /// bytes)`, in order of arrival; messages with equal arrival times are passed in the order in which they were sent.
  /// `take` must not call `send`.
  template <class Take>
  void release(std::int64_t now, Take&& take) {
    while (!waiting_.empty() && waiting_.front().arrival <= now) {
      const QueuedMessage next = pop();
      ++counts_.passed;
      take(next.tag, std::span<const std::uint8_t>(memory_[next.slot]));
    }
  }

  std::int64_t next() const;  ///< [ns] next arrival; the largest value if the queue is empty
  std::size_t waiting() const { return waiting_.size(); }
  const DelayCounts& counts() const { return counts_; }

 private:
  struct QueuedMessage {
    std::int64_t arrival = 0;  ///< [ns]
    std::uint64_t order = 0;
    std::size_t tag = 0;
    std::size_t slot = 0;
  };
  static bool later(const QueuedMessage& one, const QueuedMessage& other);
  QueuedMessage pop();
  void queue(std::int64_t arrival, std::size_t tag, std::span<const std::uint8_t> bytes,
             const std::optional<double>& flipped_bit);

  LinkModel model_;
  DelayCounts counts_;
  std::vector<QueuedMessage> waiting_;  ///< a heap; the next message is at the front
  std::vector<base::Bytes> memory_;
  std::vector<std::size_t> free_;  ///< slots of `memory_`
  std::uint64_t order_ = 0;
};

}  // namespace sf::netio
