#pragma once
// Reads a camera or a pipeline in a thread of its own, with a time limit: a driver may block forever.

#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "vision/opencv.h"

namespace sf::vision {

/// Not thread-safe. Reads an image only when one is wanted, so none is skipped. A source that ended and can be reopened
/// is opened again every `kReopenPeriod` until that succeeds; meanwhile it is stalled.
class WatchedSource {
 public:
  enum class Result {
    image,    ///< an image, or an unreadable one without pixels
    stalled,  ///< no image in time; the call under way continues, and a later `next` returns its image
    ended     ///< after the last image, or when a stop is requested
  };
  /// How long `next` waits for a source that has stalled already, which may not delay other cameras.
  static constexpr std::chrono::milliseconds kGlance{5};
  static constexpr std::chrono::milliseconds kReopenPeriod{1000};

  /// @param limit for one image  @param stop ends a wait within 50 ms; must outlive this
  WatchedSource(std::unique_ptr<ImageSource> source, std::chrono::milliseconds limit, const std::atomic<bool>& stop,
                std::chrono::milliseconds reopen_period = kReopenPeriod);
  /// Waits up to `limit` for the call under way. A thread that is still blocked then is left behind with its source.
  ~WatchedSource();
  WatchedSource(const WatchedSource&) = delete;
  WatchedSource& operator=(const WatchedSource&) = delete;

  /// @param out without pixels unless there is an image
  /// @param skipped the image is skipped (ImageSource::skip), and `out` has no pixels
  /// @throws as ImageSource::next
  Result next(Image& out, bool skipped = false);
  double rate() const { return rate_; }  ///< ImageSource::rate

 private:
  struct Shared;
  static void read_images(const std::shared_ptr<Shared>& shared);
  static bool read_one(Shared& shared, bool skipped);

  std::shared_ptr<Shared> shared_;  ///< with the thread
  std::chrono::milliseconds limit_;
  const std::atomic<bool>& stop_;
  double rate_;
  bool stalled_ = false;
};

/// Returns a source that throws a base::InputError if a live one sends no image within `limit`; files as they are.
/// @param place of the source, for the message
std::unique_ptr<ImageSource> limited(std::unique_ptr<ImageSource> source, std::string place,
                                     std::chrono::milliseconds limit = std::chrono::seconds(2));

}  // namespace sf::vision
