#pragma once
// The thread that paints frames of a run and writes them.

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "viz/run_view.h"

namespace sf::apps {

class FrameWriter {
 public:
  /// @param write called in order for every frame, by the thread, which alone paints
  FrameWriter(viz::RunView view, std::function<void(const viz::PixelImage&)> write);
  /// Joins the thread once all frames are written, or writing failed.
  ~FrameWriter();

  /// Waits while `kMostWaiting` frames wait. @throws what writing an earlier frame threw
  void add(viz::RunFrame frame);
  /// Waits until all frames are written. @throws as `add`
  void finish();

  static constexpr std::size_t kMostWaiting = 4;

 private:
  void work();
  void join();

  viz::RunView view_;
  std::function<void(const viz::PixelImage&)> write_;
  std::mutex mutex_;  ///< of all below but the thread
  std::condition_variable changed_;
  std::deque<viz::RunFrame> waiting_;
  bool is_ended_ = false;  ///< no more frames come
  std::exception_ptr failure_;
  std::thread thread_;
};

}  // namespace sf::apps
