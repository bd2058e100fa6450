#pragma once
// Compresses and writes the chunks of a recording in a thread, while the next ticks are computed.

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
  static constexpr std::size_t kMaxWaiting = 2;  ///< chunks, excluding the chunk that is being written

  /// The thread owns `mcap` and `file` from here until `finish` returns.
  ChunkWriter(McapWriter& mcap, GrowingFile& file);
  /// Calls `finish` if needed and ignores its errors.
  ~ChunkWriter();

  /// Takes a chunk and replaces it with an empty one. Blocks while `kMaxWaiting` chunks wait.
  /// @throws base::InputError if an earlier chunk could not be written completely; later chunks are then dropped
  void add(McapChunk& chunk);
  /// Blocks until all chunks are in the file, then ends the thread. @throws base::InputError in the same cases as `add`
  void finish();

 private:
  void run();
  void write(McapChunk& chunk);

  McapWriter& mcap_;
  GrowingFile& file_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<McapChunk> waiting_;
  std::vector<McapChunk> spare_;  ///< empty chunks that keep their memory
  std::exception_ptr error_;
  bool finished_ = false;
  std::thread thread_;
};

}  // namespace sf::record
