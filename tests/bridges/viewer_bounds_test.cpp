// Slow and hostile clients of the live view affect only themselves.

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <sys/resource.h>

#include <chrono>
#include <ctime>
#include <thread>

#include "tests/bridges/viewer_fixture.h"
#include "tests/refusal.h"

namespace sf::bridges {

namespace {

constexpr std::size_t kMany = 3000;  // robots: a quarter of a megabyte per tick

}  // namespace

TEST(ViewerBounds, AClientThatDoesNotReadSkipsAhead) {
  ViewerFixture fixture(ViewerMode::run, kMany);
  Watcher stuck(fixture, {"/fleet"}), reader(fixture, {"/fleet"});
  // Far more than the kernel buffers. Nothing here waits for `stuck`: each tick is published and read by `reader`.
  constexpr int kTicks = 100;
  for (int tick = 1; tick <= kTicks; ++tick) {
    fixture.tick(static_cast<std::uint64_t>(tick));
    ASSERT_EQ(subscription_tick(reader.receive_binary(1)), "101@" + std::to_string(tick)) << "the reader misses none";
  }
  EXPECT_GT(fixture.viewer->server().skipped(), 0u);
  // It finally reads complete ticks in order, with a gap, up to the newest one.
  int last = 0, gaps = 0;
  while (last < kTicks) {
    const std::string message = stuck.receive_binary(1);
    ASSERT_GT(message.size(), 85 * kMany);
    const int tick = std::stoi(subscription_tick(message).substr(4));
    ASSERT_GT(tick, last);
    gaps += tick != last + 1;
    last = tick;
  }
  EXPECT_GT(gaps, 0);
}

TEST(ViewerBounds, NoMoreUpdatesAreSkippedThanTheLimitRequires) {
  WebLimits limits;
  limits.waiting_updates = 1000;
  limits.waiting_bytes = 1'000'000;  // three ticks
  ViewerFixture fixture(ViewerMode::run, kMany, limits);
  const Watcher stuck(fixture, {"/fleet"});
  Watcher other(fixture);
  std::uint64_t skipped = 0;
  for (std::uint64_t tick = 1; tick <= 100; ++tick) {
    fixture.tick(tick);
    other.settle();
    const std::uint64_t now = fixture.viewer->server().skipped();
    ASSERT_LE(now, skipped + 1) << "frees space for one tick";
    skipped = now;
  }
  EXPECT_GT(skipped, 0u);
}

TEST(ViewerBounds, UnreadRepliesEndTheirConnection) {
  WebLimits limits;
  limits.replies = 100'000;
  ViewerFixture fixture(ViewerMode::run, 2, limits);
  Watcher stuck(fixture);
  // Each request's answer is a hundred times its size, and the answers are not read.
  std::string names = "\"/paused\"";
  for (int i = 0; i < 1000; ++i) names += ",\"/paused\"";
  bool alive = true;
  for (int i = 0; i < 200'000 && alive; ++i)
    alive = stuck.text(R"({"op":"unknown"})") &&
            stuck.text(R"({"op":"getParameters","parameterNames":[],"id":")" + std::string(10'000, 'x') + "\"}");
  EXPECT_FALSE(alive);
  EXPECT_NE(Watcher(fixture).greeting, "") << "others are served";
}

TEST(ViewerBounds, ClientsAreCounted) {
  WebLimits limits;
  limits.clients = 2;
  const ViewerFixture fixture(ViewerMode::run, 2, limits);
  const Watcher first(fixture);
  {
    const Watcher second(fixture);
    EXPECT_EQ(RawClient(fixture.port()).upgrade(kSdkV1).substr(9, 3), "503");
  }
  // The server detects the end of the second connection with a delay.
  std::string status;
  for (int i = 0; i < 100'000 && status != "101"; ++i) status = RawClient(fixture.port()).upgrade(kSdkV1).substr(9, 3);
  EXPECT_EQ(status, "101");
}

TEST(ViewerBounds, OverlongMessagesEndTheirConnection) {
  WebLimits limits;
  limits.message = 1000;
  ViewerFixture fixture(ViewerMode::run, 2, limits);
  Watcher longest(fixture), longer(fixture), liar(fixture);
  longest.text(R"({"op":"getParameters","parameterNames":[],"id":")" + std::string(900, 'x') + "\"}");
  EXPECT_NE(longest.receive_with("parameterValues"), "");
  longer.text(std::string(1001, ' '));
  EXPECT_FALSE(longer.receive());
  liar.send_frame(2, "\x01", std::uint64_t{1} << 62);  // announces four exabytes
  EXPECT_FALSE(liar.receive());
  EXPECT_NE(Watcher(fixture).greeting, "");
}

TEST(ViewerBounds, OverlongRequestsAreRefused) {
  const ViewerFixture fixture;
  RawClient client(fixture.port());
  EXPECT_EQ(client.request("/", "Host: localhost\r\nX: " + std::string(100'000, 'x') + "\r\n"), "");
  EXPECT_EQ(RawClient(fixture.port()).request("/", "Host: localhost\r\n").substr(9, 3), "200");
}

TEST(ViewerBounds, SubscriptionsAreCheckedAndBounded) {
  ViewerFixture fixture;
  Watcher client(fixture, {"/fleet"});
  const std::vector<std::pair<int, int>> wrong{{101, fixture.channel("/clock")},  // an id in use
                                               {5, fixture.channel("/fleet")},    // a channel already subscribed
                                               {5, 10'000}};                      // unknown channel
  for (const auto& [id, channel] : wrong) {
    client.subscribe(id, channel);
    EXPECT_NE(client.settle().find("\"op\":\"status\""), std::string::npos) << id << " " << channel;
  }
  client.text(R"({"op":"unsubscribe","subscriptionIds":[7,7,7]})");  // none of its own
  client.settle();
  fixture.tick(1);
  EXPECT_EQ(subscription_tick(client.receive_binary(1)), "101@1");
}

TEST(ViewerBounds, SurvivesAnyBytes) {
  ViewerFixture fixture;
  EXPECT_TRUE(rc::check("frames of any content leave the server alive", [&] {
    Watcher client(fixture, {"/fleet"});
    const auto payload = *rc::gen::container<std::string>(rc::gen::arbitrary<char>());
    const int opcode = *rc::gen::element(1, 2, 1, 2, 0, 3, 8, 9, 10, 15);
    client.send_frame(opcode, payload);
    client.send_frame(2, std::string(1, *rc::gen::element('\1', '\2', '\3')) + payload);
    client.send_raw(payload);
  }));
  EXPECT_TRUE(rc::check("requests of any content, too", [&] {
    RawClient client(fixture.port());
    client.send_raw(*rc::gen::container<std::string>(rc::gen::arbitrary<char>()) + "\r\n\r\n");
  }));
  Watcher client(fixture, {"/fleet"});
  fixture.tick(1);
  EXPECT_EQ(subscription_tick(client.receive_binary(1)), "101@1");
}

/// Without descriptors a connection waits, and so does the server: in half a second it uses little CPU time. Once
/// descriptors are available, the connection is served.
TEST(ViewerBounds, ConnectionsWaitForDescriptors) {
  ViewerFixture fixture;
  RawClient first(fixture.port());
  EXPECT_NE(first.request("/", "Host: localhost\r\n"), "");
  RawClient waiting(fixture.port(), false);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const int next = dup(0);  // the lowest free one
  close(next);
  rlimit none{static_cast<rlim_t>(next), before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::clock_t start = std::clock();
  ASSERT_TRUE(waiting.connect_now());
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const double used = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_LT(used, 0.1) << "[s] of a core";
  EXPECT_NE(waiting.request("/", "Host: localhost\r\n"), "");
}

TEST(ViewerBounds, AnAddressInUseIsNamed) {
  const ViewerFixture fixture;
  const Scene scene{fixture.world, fixture.sensor_set, fixture.info};
  expect_in(std::to_string(fixture.port()), refusal_of<std::exception>([&] {
              Viewer(scene, {{"127.0.0.1", fixture.port()}});
            }));
}

TEST(ViewerBounds, EndsWithClientsConnected) {
  auto fixture = std::make_unique<ViewerFixture>(ViewerMode::run, kMany);
  Watcher reading(*fixture, {"/fleet"}), stuck(*fixture, {"/fleet"});
  for (std::uint64_t tick = 1; tick <= 50; ++tick) fixture->tick(tick);
  fixture.reset();
  while (reading.receive()) {
  }
}

}  // namespace sf::bridges
