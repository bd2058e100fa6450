#include "vision/watched_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "base/error.h"

namespace sf::vision {

using Clock = std::chrono::steady_clock;

struct WatchedSource::Shared {
  std::unique_ptr<ImageSource> source;  ///< used by the thread only
  std::chrono::milliseconds reopen_period;
  std::mutex mutex;  ///< of all below
  std::condition_variable changed;
  enum class State { idle, wanted, done, quit, left } state = State::idle;
  bool skipped = false;  ///< the wanted image
  bool more = false;
  Image image;
  std::exception_ptr error;
};

WatchedSource::WatchedSource(std::unique_ptr<ImageSource> source, std::chrono::milliseconds limit,
                             const std::atomic<bool>& stop, std::chrono::milliseconds reopen_period)
    : shared_(std::make_shared<Shared>()), limit_(limit), stop_(stop), rate_(source->rate()) {
  shared_->source = std::move(source);
  shared_->reopen_period = reopen_period;
  // A thread inside a driver cannot be stopped.
  std::thread([shared = shared_] { read_images(shared); }).detach();
}

WatchedSource::~WatchedSource() {
  std::unique_lock lock(shared_->mutex);
  shared_->state = Shared::State::quit;
  shared_->changed.notify_all();
  shared_->changed.wait_for(lock, limit_, [this] { return shared_->state == Shared::State::left; });
}

/// Reads or skips an image, if necessary after opening the source again.
bool WatchedSource::read_one(Shared& s, bool skipped) {
  while (!(skipped ? s.source->skip() : s.source->next(s.image))) {
    if (!s.source->can_reopen()) return false;
    do {
      std::unique_lock lock(s.mutex);
      const auto quits = [&s] { return s.state == Shared::State::quit; };
      if (s.changed.wait_for(lock, s.reopen_period, quits)) return false;
      lock.unlock();
    } while (!s.source->reopen());
  }
  return true;
}

void WatchedSource::read_images(const std::shared_ptr<Shared>& shared) {
  using State = Shared::State;
  Shared& s = *shared;
  std::unique_lock lock(s.mutex);
  while (true) {
    s.changed.wait(lock, [&] { return s.state == State::wanted || s.state == State::quit; });
    if (s.state == State::quit) break;
    const bool skipped = s.skipped;
    lock.unlock();
    bool more = false;
    std::exception_ptr error;
    try {
      more = read_one(s, skipped);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    s.more = more;
    s.error = error;
    if (s.state == State::wanted) s.state = State::done;
    s.changed.notify_all();
  }
  lock.unlock();
  s.source.reset();  // closes the device
  lock.lock();
  s.state = State::left;
  s.changed.notify_all();
}

WatchedSource::Result WatchedSource::next(Image& out, bool skipped) {
  using State = Shared::State;
  constexpr std::chrono::milliseconds kSlice{50};
  Shared& s = *shared_;
  out.pixels.clear();
  std::unique_lock lock(s.mutex);
  if (s.state == State::idle) {
    s.state = State::wanted;
    s.skipped = skipped;
  }
  s.changed.notify_all();
  const Clock::time_point end = Clock::now() + (stalled_ ? std::min(limit_, kGlance) : limit_);
  while (s.state == State::wanted && !stop_ && Clock::now() < end)
    s.changed.wait_until(lock, std::min(end, Clock::now() + kSlice));
  if (s.state == State::wanted) {
    stalled_ = true;
    return stop_ ? Result::ended : Result::stalled;
  }
  s.state = State::idle;
  stalled_ = false;
  if (s.error) std::rethrow_exception(std::exchange(s.error, nullptr));
  if (!s.more) return Result::ended;
  if (s.skipped && !skipped) {  // the call under way began when no image was wanted
    lock.unlock();
    return next(out, false);
  }
  if (!s.skipped) std::swap(out, s.image);
  return Result::image;
}

namespace {

const std::atomic<bool> never{false};

class LimitedSource final : public ImageSource {
 public:
  LimitedSource(std::unique_ptr<ImageSource> source, std::string place, std::chrono::milliseconds limit)
      : source_(std::move(source), limit, never), place_(std::move(place)), limit_(limit) {}
  bool next(Image& out) override {
    const WatchedSource::Result result = source_.next(out);
    if (result == WatchedSource::Result::stalled)
      throw base::InputError(fmt::format("{} has sent no image for {:g} s; check the camera and its cable", place_,
                                         1e-3 * static_cast<double>(limit_.count())));
    return result == WatchedSource::Result::image;
  }
  bool is_live() const override { return true; }
  double rate() const override { return source_.rate(); }

 private:
  WatchedSource source_;
  std::string place_;
  std::chrono::milliseconds limit_;
};

}  // namespace

std::unique_ptr<ImageSource> limited(std::unique_ptr<ImageSource> source, std::string place,
                                     std::chrono::milliseconds limit) {
  if (!source->is_live()) return source;
  return std::make_unique<LimitedSource>(std::move(source), std::move(place), limit);
}

}  // namespace sf::vision
