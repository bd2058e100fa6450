#pragma once
// Queue of messages to DDS. A thread writes them, because a write waits for slow readers.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

#include "bridges/dds.h"

namespace sf::bridges {

struct DdsOutgoing {
  std::size_t writer = 0;
  base::Bytes message;
};

/// The messages of one tick, in memory that is reused.
class DdsBatch {
 public:
  /// Returns a cleared buffer for a message.
  base::Bytes& add(std::size_t writer);
  void clear() { size_ = 0; }
  std::span<const DdsOutgoing> messages() const { return std::span(rows_).first(size_); }

 private:
  std::vector<DdsOutgoing> rows_;
  std::size_t size_ = 0;
};

/// A reply to a client whose reader may not have been discovered yet.
struct DdsReply {
  std::size_t writer = 0, reader = 0;
  std::uint64_t sender = 0;  ///< of the request
  base::Bytes message;
};

class DdsOutbox {
 public:
  static constexpr std::size_t kMaxTicks = 8;       ///< maximum number queued; the oldest is dropped beyond it
  static constexpr std::size_t kMaxReplies = 1024;  ///< maximum number queued; more are dropped

  explicit DdsOutbox(DdsParticipant& participant);
  ~DdsOutbox();  ///< drops queued messages

  /// Queues the messages of a tick and replaces them by an empty batch. Never blocks.
  void add(DdsBatch& tick);
  void add(DdsReply&& reply);

  struct Counts {
    std::uint64_t written = 0;
    std::uint64_t ticks_left_out = 0;  ///< dropped ticks: all readers were behind
    std::uint64_t left_out = 0;        ///< dropped messages, whose own readers were behind, and dropped replies
  };
  Counts counts() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct WaitingReply : DdsReply {
    Clock::time_point until;  ///< time at which it is written in any case
  };
  void run();
  void write(const DdsBatch& tick);
  void write_replies();
  /// Returns false if its readers are behind.
  bool write(std::size_t writer, const base::Bytes& message);

  DdsParticipant& participant_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  std::deque<DdsBatch> ticks_;
  std::vector<DdsBatch> spare_;
  std::deque<DdsReply> replies_;
  Counts counts_;

  // Used by the thread only.
  std::deque<WaitingReply> waiting_;
  std::vector<Clock::time_point> behind_until_;  ///< per writer
  std::thread thread_;
};

}  // namespace sf::bridges
