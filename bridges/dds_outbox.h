#pragma once
// Messages on their way to DDS. A thread writes them, since a write waits for slow readers.

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

/// Messages of one tick, and memory for further ones.
class DdsBatch {
 public:
  /// A cleared buffer for a message.
  base::Bytes& add(std::size_t writer);
  void clear() { size_ = 0; }
  std::span<const DdsOutgoing> messages() const { return std::span(rows_).first(size_); }

 private:
  std::vector<DdsOutgoing> rows_;
  std::size_t size_ = 0;
};

/// An answer to a client whose reader may not be known yet.
struct DdsReply {
  std::size_t writer = 0, reader = 0;
  std::uint64_t sender = 0;  ///< of the question
  base::Bytes message;
};

class DdsOutbox {
 public:
  static constexpr std::size_t kMaxTicks = 8;       ///< that wait; of more, the oldest is left out
  static constexpr std::size_t kMaxReplies = 1024;  ///< that wait; more are left out

  explicit DdsOutbox(DdsParticipant& participant);
  ~DdsOutbox();  ///< what waits is left out

  /// Takes a tick's messages, and gives an empty batch for the next. Never waits.
  void add(DdsBatch& tick);
  void add(DdsReply&& reply);

  struct Counts {
    std::uint64_t written = 0;
    std::uint64_t ticks_left_out = 0;  ///< all readers were behind
    std::uint64_t left_out = 0;        ///< messages whose own readers were behind, and replies
  };
  Counts counts() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct WaitingReply : DdsReply {
    Clock::time_point until;  ///< then it is written in any case
  };
  void run();
  void write(const DdsBatch& tick);
  void write_replies();
  /// @return false: its readers are behind
  bool write(std::size_t writer, const base::Bytes& message);

  DdsParticipant& participant_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  std::deque<DdsBatch> ticks_;
  std::vector<DdsBatch> spare_;
  std::deque<DdsReply> replies_;
  Counts counts_;

  // Of the thread alone.
  std::deque<WaitingReply> waiting_;
  std::vector<Clock::time_point> behind_until_;  ///< by writer
  std::thread thread_;
};

}  // namespace sf::bridges
