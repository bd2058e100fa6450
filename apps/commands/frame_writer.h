#pragma once
// A thread that paints and writes the frames of a run.

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "viz/run_view.h"

namespace sf::apps {

class FrameWriter {
 public:
  /// @param write called for every frame in order, on the thread; only this thread paints
  FrameWriter(viz::RunView view, std::function<void(const viz::PixelImage&)> write);
  /// Waits until all frames are written or writing has failed, and joins the thread.
  ~FrameWriter();

  /// Queues a frame. Blocks while `kMostWaiting` frames are queued.
  /// @throws the exception that writing an earlier frame threw
  void add(viz::RunFrame frame);
  /// Waits until all frames are written. @throws as `add`
  void finish();

  static constexpr std::size_t kMostWaiting = 4;

 private:
  void work();
  void join();

  viz::RunView view_;
  std::function<void(const viz::PixelImage&)> write_;
  std::mutex mutex_;  ///< guards all members below except the thread
  std::condition_variable changed_;
  std::deque<viz::RunFrame> waiting_;
  bool is_ended_ = false;  ///< no more frames will be added
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sf::apps
