#pragma once
// Chunks on their way into a recording. A thread compresses and writes them, while the next ticks are computed.

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "record/mcap_writer.h"
#include "record/recording_files.h"

namespace sf::record {

class ChunkWriter {
 public:
  static constexpr std::size_t kMaxWaiting = 2;  ///< chunks, not counting the one that is being written

  /// From here on, `mcap` and `file` are the thread's, until `finish` returns.
  ChunkWriter(McapWriter& mcap, GrowingFile& file);
  /// Calls `finish` if needed and ignores its errors.
  ~ChunkWriter();

  /// Takes a chunk and gives an empty one. Waits while `kMaxWaiting` chunks wait.
  /// @throws base::InputError once an earlier chunk could not be written whole; later ones are left out then
  void add(McapChunk& chunk);
  /// Returns when all chunks are in the file, and ends the thread. @throws base::InputError as `add` does
  void finish();

 private:
  void run();
  void write(McapChunk& chunk);

  McapWriter& mcap_;
  GrowingFile& file_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<McapChunk> waiting_;
  std::vector<McapChunk> spare_;  ///< empty, with their memory
  std::exception_ptr error_;
  bool finished_ = false;
  std::thread thread_;
};

}  // namespace sf::record
