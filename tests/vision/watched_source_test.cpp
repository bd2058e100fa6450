// Cameras that stall.

#include "vision/watched_source.h"

#include <gtest/gtest.h>

#include <semaphore>
#include <thread>

#include "base/error.h"
#include "tests/refusal.h"

namespace sf::vision {

namespace {

using Result = WatchedSource::Result;
using namespace std::chrono_literals;

/// Script of a camera. It must outlive the source's thread, which may outlive the source.
struct Feed {
  std::counting_semaphore<> images{0};
  std::atomic<int> left{1000};  ///< images until the end
  std::atomic<bool> fails{false}, closed{false};
  std::atomic<int> reopens{-1};  ///< attempts until it opens; negative: it cannot
};

class Blocking : public ImageSource {
 public:
  explicit Blocking(std::shared_ptr<Feed> camera) : camera_(std::move(camera)) {}
  ~Blocking() override { camera_->closed = true; }
  bool next(Image& out) override {
    camera_->images.acquire();
    if (camera_->fails) throw base::InputError("the camera failed");
    if (camera_->left-- == 0) return false;
    out = {1, 1, 1, {static_cast<std::uint8_t>(++count_)}};
    return true;
  }
  bool is_live() const override { return true; }
  double rate() const override { return 12.0; }
  bool can_reopen() const override { return camera_->reopens >= 0; }
  /// Succeeds the last time.
  bool reopen() override {
    camera_->left = 1000;
    return --camera_->reopens == 0;
  }

 private:
  std::shared_ptr<Feed> camera_;
  int count_ = 0;
};

struct WatchedSourceTest : testing::Test {
  std::unique_ptr<WatchedSource> watch(std::chrono::milliseconds limit) const {
    return std::make_unique<WatchedSource>(std::make_unique<Blocking>(camera), limit, stop);
  }
  /// The next result that is not `stalled`.
  static Result finally(WatchedSource& source, Image& image) {
    Result result = Result::stalled;
    while ((result = source.next(image)) == Result::stalled) std::this_thread::yield();
    return result;
  }
  std::shared_ptr<Feed> camera = std::make_shared<Feed>();
  std::atomic<bool> stop{false};
};

}  // namespace

TEST_F(WatchedSourceTest, DeliversEveryImageAndTheEnd) {
  camera->left = 3;
  camera->images.release(4);
  const auto source = watch(1h);
  EXPECT_EQ(source->rate(), 12.0);
  Image image;
  for (const int expected : {1, 2, 3}) {
    ASSERT_EQ(source->next(image), Result::image);
    EXPECT_EQ(image.pixels, std::vector<std::uint8_t>{static_cast<std::uint8_t>(expected)});
  }
  EXPECT_EQ(source->next(image), Result::ended);
  EXPECT_TRUE(image.pixels.empty());
}

/// A limit of 0, so that the test does not wait.
TEST_F(WatchedSourceTest, AStalledCameraReturnsAndContinuesWithItsNextImage) {
  const auto source = watch(0ms);
  Image image{1, 1, 1, {9}};
  for (int i = 0; i < 3; ++i) EXPECT_EQ(source->next(image), Result::stalled);
  EXPECT_TRUE(image.pixels.empty()) << "not an old image";
  camera->images.release();
  ASSERT_EQ(finally(*source, image), Result::image);
  EXPECT_EQ(image.pixels, std::vector<std::uint8_t>{1}) << "none is lost";
  EXPECT_EQ(source->next(image), Result::stalled);
  camera->images.release();
}

TEST_F(WatchedSourceTest, SkipsImages) {
  const auto source = watch(1h);
  camera->images.release(2);
  Image image{1, 1, 1, {9}};
  EXPECT_EQ(source->next(image, true), Result::image);
  EXPECT_TRUE(image.pixels.empty());
  ASSERT_EQ(source->next(image), Result::image);
  EXPECT_EQ(image.pixels, std::vector<std::uint8_t>{2});
}

/// The skipped image arrives late: the one that is wanted then is the next.
TEST_F(WatchedSourceTest, AnImageWantedAfterASkippedOneIsRead) {
  const auto source = watch(0ms);
  Image image;
  EXPECT_EQ(source->next(image, true), Result::stalled);
  camera->images.release(2);
  ASSERT_EQ(finally(*source, image), Result::image);
  EXPECT_EQ(image.pixels, std::vector<std::uint8_t>{2});
}

TEST_F(WatchedSourceTest, ADeviceThatEndedIsOpenedAgain) {
  camera->left = 1;
  camera->reopens = 3;
  camera->images.release(3);
  WatchedSource source(std::make_unique<Blocking>(camera), 1h, stop, 0ms);
  Image image;
  ASSERT_EQ(source.next(image), Result::image);
  ASSERT_EQ(source.next(image), Result::image);
  EXPECT_EQ(image.pixels, std::vector<std::uint8_t>{2});
  EXPECT_EQ(camera->reopens, 0);
}

/// A device that does not come back is a stalled one, and does not delay the end.
TEST_F(WatchedSourceTest, ADeviceThatStaysAwayIsStalled) {
  camera->left = 0;
  camera->reopens = 1;
  camera->images.release(1);
  {
    WatchedSource source(std::make_unique<Blocking>(camera), 1ms, stop, 1h);
    Image image;
    EXPECT_EQ(source.next(image), Result::stalled);
  }
  while (!camera->closed) std::this_thread::yield();
  EXPECT_EQ(camera->reopens, 1);
}

TEST_F(WatchedSourceTest, AStopEndsTheWait) {
  const auto source = watch(1h);
  std::thread stopping([&] { stop = true; });
  Image image;
  EXPECT_EQ(source->next(image), Result::ended) << "not after an hour";
  stopping.join();
  camera->images.release();  // for the destructor, which waits for the call under way
}

TEST_F(WatchedSourceTest, ErrorsReachTheCaller) {
  camera->fails = true;
  camera->images.release();
  const auto source = watch(1h);
  Image image;
  EXPECT_THROW(source->next(image), base::InputError);
}

/// The thread is left behind, and closes the camera once the driver returns.
TEST_F(WatchedSourceTest, ABlockedCameraDoesNotBlockTheEnd) {
  {
    const auto source = watch(0ms);
    Image image;
    EXPECT_EQ(source->next(image), Result::stalled);
  }
  camera->images.release();
  while (!camera->closed) std::this_thread::yield();
}

TEST_F(WatchedSourceTest, ALimitedCameraThatStallsIsAnError) {
  const auto source = limited(std::make_unique<Blocking>(camera), "/dev/video7", 0ms);
  Image image;
  expect_in("/dev/video7 has sent no image for 0 s; check the camera and its cable",
            refusal_of([&] { source->next(image); }));
  camera->images.release();
}

}  // namespace sf::vision
