// The live view of cameras as seen by its clients.

#include "bridges/image_view.h"

#include <gtest/gtest.h>

#include <cstring>

#include "record/cdr.h"
#include "record/ros_messages.h"
#include "tests/bridges/raw_client.h"

namespace sf::bridges {

namespace {

const std::vector<std::string> kCameras{"north", "south"};

/// Without a pause between updates, so that tests do not depend on the clock.
ImageViewOptions without_pause() { return {.address = {"127.0.0.1", 0}, .interval = 0.0}; }

/// A client with subscriptions 101, 102, ... to channels: 0 and 1 are the cameras, 2 is /tags.
struct ImageWatcher : RawClient {
  ImageWatcher(const ImageView& view, std::initializer_list<int> channels) : RawClient(view.server().port()) {
    upgrade(kWebSocketV1);
    int id = 101;
    for (const int channel : channels)
      text(R"({"op":"subscribe","subscriptions":[{"id":)" + std::to_string(id++) + R"(,"channelId":)" +
           std::to_string(channel) + "}]}");
    greeting = settle();
  }
  std::string greeting;
};

std::vector<std::size_t> wait_for_turn(ImageView& view) {
  for (;;)
    if (const auto cameras = view.wanted()) return *cameras;  // the last publish took some time, too
}

base::Bytes picture(std::size_t size, std::uint8_t value) { return base::Bytes(size, value); }

std::span<const std::uint8_t> message_of(const std::string& payload) {
  return {reinterpret_cast<const std::uint8_t*>(payload.data()) + 12, payload.size() - 12};
}

}  // namespace

TEST(ImageView, SendsImagesAndTagsToTheirSubscribers) {
  ImageView view("lab", kCameras, without_pause());
  EXPECT_FALSE(view.wanted()) << "there are no clients";
  ImageWatcher both(view, {1, 2});
  EXPECT_NE(both.greeting.find("/south/image/compressed"), std::string::npos) << both.greeting;
  EXPECT_NE(both.greeting.find("sensor_msgs/msg/CompressedImage"), std::string::npos);
  EXPECT_EQ(wait_for_turn(view), std::vector<std::size_t>{1}) << "the other camera is not encoded";
  const std::vector<SeenTag> tags{{7, {1.0, -2.0, 0.2, 0.5}, {0.25, 0.0, -1.0}, 2}};
  view.publish(3'500'000'000, {{1, picture(5, 0xAB)}}, tags);

  std::int64_t time = 0;
  const std::string seen = both.receive_binary(1), image = both.receive_binary(1);
  record::CdrReader of_tags(message_of(seen));
  record::get_header(of_tags, time);
  EXPECT_EQ(time, 3'500'000'000);
  EXPECT_EQ(of_tags.get_count(1), 1u);
  EXPECT_EQ(of_tags.get<std::uint32_t>(), 7u);
  for (const double value : {1.0, -2.0, 0.2, 0.5, 0.25, 0.0, -1.0}) EXPECT_EQ(of_tags.get<double>(), value);
  EXPECT_EQ(of_tags.get<std::uint32_t>(), 2u);
  record::CdrReader of_image(message_of(image));
  EXPECT_EQ(record::get_header(of_image, time), "south");
  EXPECT_EQ(of_image.get_string(), "jpeg");
  EXPECT_EQ(of_image.get_count(1), 5u);
  EXPECT_EQ(of_image.get<std::uint8_t>(), 0xAB);
  EXPECT_EQ(of_image.left(), 4u);
}

/// `stuck` reads nothing. Nothing waits for it: each image is published and read by `reader`.
TEST(ImageView, AClientThatDoesNotReadLosesImages) {
  ImageView view("lab", kCameras, without_pause());
  ImageWatcher stuck(view, {0}), reader(view, {0});
  constexpr int kImages = 60;
  for (int k = 1; k <= kImages; ++k) {
    wait_for_turn(view);
    view.publish(k, {{0, picture(400'000, static_cast<std::uint8_t>(k))}}, {});
    ASSERT_EQ(static_cast<std::uint8_t>(reader.receive_binary(1).back()), k) << "the reader misses none";
  }
  EXPECT_GT(view.server().skipped(), 0u);
  int last = 0, count = 0;
  for (; last < kImages; ++count) {
    const int now = static_cast<std::uint8_t>(stuck.receive_binary(1).back());
    ASSERT_GT(now, last);
    last = now;
  }
  EXPECT_LT(count, kImages) << "the newest one arrives, others are lost";
}

TEST(ImageView, PausesBetweenUpdates) {
  ImageViewOptions options = without_pause();
  options.interval = 3600.0;
  ImageView view("lab", kCameras, options);
  const ImageWatcher watcher(view, {0, 1, 2});
  ASSERT_EQ(wait_for_turn(view), (std::vector<std::size_t>{0, 1}));
  view.publish(0, {}, {});
  EXPECT_FALSE(view.wanted());
}

TEST(ImageView, ServesItsPageAndRefusesForeignOnes) {
  const ImageView view("lab", kCameras, without_pause());
  const auto status = [&](const std::string& target, const std::string& headers) {
    return RawClient(view.server().port()).request(target, headers).substr(9, 3);
  };
  EXPECT_EQ(status("/", "Host: localhost\r\n"), "200");
  EXPECT_EQ(status("/cameras.js", "Host: localhost\r\n"), "200");
  EXPECT_EQ(status("/index.html", "Host: localhost\r\n"), "404") << "the page of a run";
  EXPECT_EQ(status("/", "Host: attacker.example\r\n"), "403");
  RawClient foreign(view.server().port());
  EXPECT_EQ(foreign.upgrade(kSdkV1, "Origin: https://attacker.example\r\n").substr(9, 3), "403");
}

}  // namespace sf::bridges
