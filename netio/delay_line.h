#pragma once
// A worse network than the one there is: messages wait here until they would have come, or never do.

#include <cstdint>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "netio/link_model.h"

namespace sf::netio {

struct DelayCounts {
  std::uint64_t passed = 0;  ///< released
  std::uint64_t lost = 0;    ///< as the plan has it
  std::uint64_t full = 0;    ///< more than kCapacity waited; never where loss is counted alone
};

/// One thread. Memory of messages is used again.
class DelayLine {
 public:
  static constexpr std::size_t kCapacity = 65'536;

  explicit DelayLine(const LinkModel& model) : model_(model) {}

  /// Takes a message that is sent at `now` [ns]; copies its bytes.
  /// @param tag comes back with it
  void send(const MessageId& message, std::int64_t now, std::size_t tag, std::span<const std::uint8_t> bytes);

  /// Gives `take(std::size_t tag, std::span<const std::uint8_t> bytes)` all that has come by `now` [ns], in order of
  /// arrival; of two that come at once the one that was sent first. `take` may not send.
  template <class Take>
  void release(std::int64_t now, Take&& take) {
    while (!waiting_.empty() && waiting_.front().arrival <= now) {
      const QueuedMessage next = pop();
      ++counts_.passed;
      take(next.tag, std::span<const std::uint8_t>(memory_[next.slot]));
    }
  }

  std::int64_t next() const;  ///< [ns] when the next one comes; the largest there is while none is on its way
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

  LinkModel model_;
  DelayCounts counts_;
  std::vector<QueuedMessage> waiting_;  ///< a heap, the next one in front
  std::vector<base::Bytes> memory_;
  std::vector<std::size_t> free_;  ///< slots of `memory_`
  std::uint64_t order_ = 0;
};

}  // namespace sf::netio
