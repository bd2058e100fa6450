#include "bridges/dds_outbox.h"

#include <utility>

namespace sf::bridges {

namespace {

constexpr std::chrono::milliseconds kRest{500};      // pause before writing again to readers that were behind
constexpr std::chrono::milliseconds kMaxWait{100};   // for the reader of a reply, as in rmw_cyclonedds
constexpr std::chrono::milliseconds kLookAgain{10};  // interval of checks for it

}  // namespace

base::Bytes& DdsBatch::add(std::size_t writer) {
  if (size_ == rows_.size()) rows_.emplace_back();
  DdsOutgoing& row = rows_[size_++];
  row.writer = writer;
  row.message.clear();
  return row.message;
}

DdsOutbox::DdsOutbox(DdsParticipant& participant) : participant_(participant), thread_([this] { run(); }) {}

DdsOutbox::~DdsOutbox() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void DdsOutbox::add(DdsBatch& tick) {
  {
    const std::lock_guard lock(mutex_);
    ticks_.push_back(std::move(tick));
    tick = {};
    if (ticks_.size() > kMaxTicks) {
      spare_.push_back(std::move(ticks_.front()));
      ticks_.pop_front();
      ++counts_.ticks_left_out;
    }
    if (!spare_.empty()) {
      tick = std::move(spare_.back());
      spare_.pop_back();
    }
  }
  tick.clear();
  changed_.notify_one();
}

void DdsOutbox::add(DdsReply&& reply) {
  {
    const std::lock_guard lock(mutex_);
    if (replies_.size() < kMaxReplies)
      replies_.push_back(std::move(reply));
    else
      ++counts_.left_out;
  }
  changed_.notify_one();
}

DdsOutbox::Counts DdsOutbox::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void DdsOutbox::run() {
  std::unique_lock lock(mutex_);
  const auto due = [this] { return stop_ || !ticks_.empty() || (!replies_.empty() && waiting_.size() < kMaxReplies); };
  while (true) {
    if (waiting_.empty())
      changed_.wait(lock, due);
    else
      changed_.wait_for(lock, kLookAgain, due);
    if (stop_) return;
    for (; !replies_.empty() && waiting_.size() < kMaxReplies; replies_.pop_front())
      waiting_.push_back({{std::move(replies_.front())}, Clock::now() + kMaxWait});
    DdsBatch tick;
    const bool has_tick = !ticks_.empty();
    if (has_tick) {
      tick = std::move(ticks_.front());
      ticks_.pop_front();
    }
    lock.unlock();
    write_replies();
    write(tick);
    lock.lock();
    if (has_tick) spare_.push_back(std::move(tick));
  }
}

void DdsOutbox::write(const DdsBatch& tick) {
  for (const DdsOutgoing& each : tick.messages()) {
    if (behind_until_.size() <= each.writer) behind_until_.resize(each.writer + 1);
    const bool resting = Clock::now() < behind_until_[each.writer];
    if (!resting && !write(each.writer, each.message)) behind_until_[each.writer] = Clock::now() + kRest;
    if (!resting) continue;
    const std::lock_guard lock(mutex_);
    ++counts_.left_out;
  }
}

void DdsOutbox::write_replies() {
  std::erase_if(waiting_, [this](const WaitingReply& reply) {
    if (Clock::now() < reply.until && !participant_.can_answer(reply.writer, reply.reader, reply.sender)) return false;
    write(reply.writer, reply.message);
    return true;
  });
}

bool DdsOutbox::write(std::size_t writer, const base::Bytes& message) {
  const bool written = participant_.write(writer, message);
  const std::lock_guard lock(mutex_);
  ++(written ? counts_.written : counts_.left_out);
  return written;
}

}  // namespace sf::bridges
