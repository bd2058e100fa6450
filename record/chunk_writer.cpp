#include "record/chunk_writer.h"

#include <utility>

#include "base/error.h"

namespace sf::record {

ChunkWriter::ChunkWriter(McapWriter& mcap, GrowingFile& file) : mcap_(mcap), file_(file), thread_([this] { run(); }) {}

ChunkWriter::~ChunkWriter() {
  try {
    finish();
  } catch (const base::InputError&) {
    // The earlier chunks are in the file.
  }
}

void ChunkWriter::add(McapChunk& chunk) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < kMaxWaiting || error_ != nullptr; });
  if (error_ != nullptr) std::rethrow_exception(error_);
  waiting_.push_back(std::move(chunk));
  chunk = {};
  if (!spare_.empty()) {
    chunk = std::move(spare_.back());
    spare_.pop_back();
  }
  lock.unlock();
  changed_.notify_all();
}

void ChunkWriter::finish() {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (error_ != nullptr) std::rethrow_exception(std::exchange(error_, nullptr));
}

void ChunkWriter::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return finished_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    McapChunk chunk = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    std::exception_ptr error;
    try {
      write(chunk);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    spare_.push_back(std::move(chunk));
    if (error != nullptr) error_ = error, waiting_.clear();
    changed_.notify_all();
    if (error != nullptr) return;
  }
}

void ChunkWriter::write(McapChunk& chunk) {
  mcap_.write(chunk);
  file_.append(mcap_.pending());
  mcap_.drained();
}

}  // namespace sf::record
