#include "netio/listener.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>
#include <thread>

#include "base/error.h"
#include "netio/endpoint.h"
#include "netio/outbox.h"
#include "tests/netio/examples.h"

namespace sf::netio {
namespace {

constexpr int kPatience = 5000;  ///< [ms] longest wait for what loopback has already been given

/// One sensor on each of `robots`, at two ports a robot.
std::vector<StreamPlan> plans(std::uint32_t robots, std::uint32_t samples = 3, double range_max = 8.0) {
  std::vector<StreamPlan> streams;
  for (std::uint32_t id = 0; id < robots; ++id) streams.push_back({id, 0, samples, range_max, {12'000, 2}});
  return streams;
}

/// A listener at the first base port that is free, below the ports Linux lends out: other tests may run beside this
/// one. Moves `streams` there.
std::unique_ptr<Listener> listen(std::vector<StreamPlan>& streams, Wire wire = Wire::farm) {
  for (std::uint32_t base = 12'000; base < 32'000; base += 200) {
    for (StreamPlan& plan : streams) plan.rule.base = base;
    try {
      return std::make_unique<Listener>(ListenerOptions{.wire = wire, .streams = streams});
    } catch (const base::InputError&) {
      continue;  // taken
    }
  }
  throw base::InputError("no 200 free ports between 12000 and 32000");
}

void send_scan(Outbox& outbox, const StreamPlan& plan, std::uint32_t sequence, const std::vector<double>& ranges,
               Wire wire = Wire::farm) {
  const auto to = static_cast<std::uint16_t>(port(plan.rule, plan.robot, plan.sensor));
  const Header header{.robot = static_cast<std::uint16_t>(plan.robot),
                      .sensor = static_cast<std::uint16_t>(plan.sensor),
                      .sequence = sequence};
  outbox.queue_laser({kLoopback, to}, wire, header, ranges, plan.range_max);
}

void drain(Listener& listener, std::uint64_t until) {
  while (listener.summary().datagrams < until && listener.drain(kPatience) > 0) {
  }
}

TEST(Listener, AThousandLaserPacketsArrive) {
  auto streams = plans(100, 361);
  const auto listener = listen(streams);
  Outbox outbox;
  const std::vector<double> ranges(361, 2.5);
  for (std::uint32_t scan = 0; scan < 10; ++scan) {
    for (const StreamPlan& plan : streams) send_scan(outbox, plan, scan, ranges);
    outbox.flush();
    drain(*listener, 100 * (scan + 1));
  }
  const Summary sum = listener->summary();
  EXPECT_EQ(outbox.counts().sent, 1000u);
  EXPECT_EQ(outbox.counts().sent_bytes, 748'000u);
  EXPECT_EQ(sum.datagrams, 1000u);
  EXPECT_EQ(sum.good, 1000u);
  EXPECT_EQ(sum.bytes, 748'000u);
  EXPECT_EQ(sum.rays, 361'000u);
  EXPECT_EQ(sum.lost + sum.duplicates + sum.reordered + sum.silent_ports, 0u);
  EXPECT_EQ(sum.ports, 100u);
  EXPECT_GT(sum.receive_buffer, 0u);
}

TEST(Listener, RunsUntilSilence) {
  auto streams = plans(1);
  const auto listener = listen(streams);
  Outbox outbox;
  send_scan(outbox, streams[0], 0, {1, 2, 3});
  outbox.flush();
  const std::atomic<bool> stop = false;
  listener->run(stop, 0);
  EXPECT_EQ(listener->summary().good, 1u);
}

TEST(Listener, RunsUntilToldToStop) {
  auto streams = plans(1);
  const auto listener = listen(streams);
  std::atomic<bool> stop = false;
  std::thread other([&] { stop = true; });
  listener->run(stop, 1'000'000);
  other.join();
  EXPECT_EQ(listener->summary().silent_ports, 1u);
}

TEST(Listener, ExtendedScansAreCountedByPart) {
  auto streams = plans(1, 1000, 100.0);
  const auto listener = listen(streams);
  Outbox outbox;
  send_scan(outbox, streams[0], 0, std::vector<double>(1000, 99.0));
  send_scan(outbox, streams[0], 2, std::vector<double>(1000, INFINITY));  // scan 1 never came: three parts
  outbox.flush();
  drain(*listener, 6);
  EXPECT_EQ(listener->summary().good, 6u);
  EXPECT_EQ(listener->summary().rays, 2000u);
  EXPECT_EQ(listener->summary().lost, 3u);
}

TEST(Listener, TheThesisLayoutIsCheckedToo) {
  auto streams = plans(1);
  const auto listener = listen(streams, Wire::thesis);
  Outbox outbox;
  send_scan(outbox, streams[0], 0, {1, 2, 3}, Wire::thesis);
  send_scan(outbox, streams[0], 0, {1, 2}, Wire::thesis);
  send_scan(outbox, streams[0], 0, {1, 2, 9}, Wire::thesis);
  outbox.flush();
  drain(*listener, 3);
  EXPECT_EQ(listener->summary().good, 1u);
  EXPECT_EQ(listener->summary().counts[Reason::out_of_range], 2u);
}

struct OnePort : testing::Test {
  std::vector<StreamPlan> streams = plans(2);
  std::unique_ptr<Listener> listener = listen(streams);
  Reason say(std::uint16_t robot, std::uint16_t sensor, std::uint32_t sequence, const std::vector<double>& ranges) {
    base::Bytes bytes;
    EXPECT_TRUE(
        encode_laser(Wire::farm, {.robot = robot, .sensor = sensor, .sequence = sequence}, ranges, 8.0, 0, bytes));
    return listener->accept(1, bytes);
  }
};

TEST_F(OnePort, ChecksWhatItCarries) {
  EXPECT_EQ(say(1, 0, 0, {0, 8, 8.001}), Reason::accepted);      // rounding may add one count
  EXPECT_EQ(say(1, 0, 1, {0, 8, INFINITY}), Reason::accepted);   // saturated: no return
  EXPECT_EQ(say(1, 0, 2, {0, 8, 8.002}), Reason::out_of_range);  // farther than the sensor sees
  EXPECT_EQ(say(1, 0, 3, {0, 8}), Reason::out_of_range);         // a ray is missing
  EXPECT_EQ(say(0, 0, 4, {1, 2, 3}), Reason::wrong_source);      // another robot's
  EXPECT_EQ(say(1, 1, 5, {1, 2, 3}), Reason::wrong_source);      // another sensor's
  EXPECT_EQ(listener->accept(1, v2v_example()), Reason::wrong_direction);
  EXPECT_EQ(listener->accept(1, base::Bytes{1, 2}), Reason::too_short);
  const Summary sum = listener->summary();
  EXPECT_EQ(sum.datagrams, 8u);
  EXPECT_EQ(sum.good, 2u);
  EXPECT_EQ(sum.rays, 6u);
  EXPECT_EQ(sum.silent_ports, 1u);
}

TEST_F(OnePort, SeesLossDuplicatesAndReordering) {
  for (const std::uint32_t sequence : {0, 1, 1, 5, 4, 6}) say(1, 0, sequence, {1, 2, 3});
  const Summary sum = listener->summary();
  EXPECT_EQ(sum.good, 6u);
  EXPECT_EQ(sum.duplicates, 1u);
  EXPECT_EQ(sum.reordered, 1u);
  EXPECT_EQ(sum.lost, 2u);
}

TEST(Listener, CollidingPortsAreRefused) {
  std::vector<StreamPlan> streams = plans(2);
  streams.push_back({0, 2, 3, 8.0, {12'000, 2}});  // sensor 2 runs into robot 1
  EXPECT_THROW(Listener({.streams = streams}), base::InputError);
}

TEST(Listener, ATakenPortIsRefused) {
  auto streams = plans(1);
  const auto first = listen(streams);
  EXPECT_THROW(Listener({.streams = streams}), base::InputError);
}

TEST(Outbox, RefusedDatagramsAreCountedWithTheFirstReason) {
  Outbox outbox;
  outbox.queue({kLoopback, 0}, base::Bytes{1});  // port 0 is nowhere
  outbox.queue({kLoopback, 0}, base::Bytes{1});
  outbox.queue({kLoopback, 9}, base::Bytes{1});  // nobody listens: that is not an error
  outbox.flush();
  EXPECT_EQ(outbox.counts().queued, 3u);
  EXPECT_EQ(outbox.counts().failed, 2u);
  EXPECT_EQ(outbox.counts().sent, 1u);
  EXPECT_EQ(outbox.counts().dropped, 0u);
  EXPECT_EQ(outbox.counts().first_failure.rfind("127.0.0.1:0: ", 0), 0u) << outbox.counts().first_failure;
}

TEST(Outbox, AFullOneFlushesItself) {
  Outbox outbox({.capacity = 4});
  for (int i = 0; i < 10; ++i) outbox.queue({kLoopback, 9}, base::Bytes{1, 2, 3});
  EXPECT_EQ(outbox.counts().sent, 8u);
  outbox.flush();
  outbox.flush();  // nothing left
  EXPECT_EQ(outbox.counts().sent, 10u);
  EXPECT_EQ(outbox.counts().sent_bytes, 30u);
}

TEST(Outbox, ScansWithANanAreCountedNotSent) {
  Outbox outbox;
  outbox.queue_laser({kLoopback, 9}, Wire::farm, {}, std::vector{1.0, std::nan("")}, 8.0);
  outbox.flush();
  EXPECT_EQ(outbox.counts().not_numbers, 1u);
  EXPECT_EQ(outbox.counts().queued, 0u);
}

TEST(Endpoint, ResolvesAndPrints) {
  EXPECT_EQ(resolve("127.0.0.1"), kLoopback);
  EXPECT_EQ(text(Endpoint{0xC0000201u, 10008}), "192.0.2.1:10008");
  EXPECT_THROW(resolve("no host has a space"), base::InputError);
}

TEST(Endpoint, ResolvesNames) {
  if (access("/etc/hosts", R_OK) != 0) GTEST_SKIP() << "this machine has no /etc/hosts, so it need not know localhost";
  EXPECT_EQ(resolve("localhost"), kLoopback);
}

}  // namespace
}  // namespace sf::netio
