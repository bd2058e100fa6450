#include "apps/commands/frame_writer.h"

#include <utility>

namespace sf::apps {

FrameWriter::FrameWriter(viz::RunView view, std::function<void(const viz::PixelImage&)> write)
    : view_(std::move(view)), write_(std::move(write)), thread_([this] { work(); }) {}

FrameWriter::~FrameWriter() { join(); }

void FrameWriter::add(viz::RunFrame frame) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.size() < kMostWaiting || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  waiting_.push_back(std::move(frame));
  changed_.notify_all();
}

void FrameWriter::finish() {
  join();
  if (failure_) std::rethrow_exception(failure_);
}

void FrameWriter::join() {
  {
    const std::lock_guard lock(mutex_);
    is_ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void FrameWriter::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !waiting_.empty() || is_ended_; });
    if (waiting_.empty()) return;
    const viz::RunFrame frame = std::move(waiting_.front());
    waiting_.pop_front();
    changed_.notify_all();
    lock.unlock();
    std::exception_ptr failure;
    try {
      write_(view_.paint(frame));
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    if (!failure) continue;
    failure_ = failure;
    changed_.notify_all();
    return;
  }
}

}  // namespace sf::apps
