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
std::vector<StreamPlan> plans(std::uint32_t robots) {
  std::vector<StreamPlan> streams;
  for (std::uint32_t id = 0; id < robots; ++id) streams.push_back({id, 0, {12'000, 2}});
  return streams;
}

/// A made-up kind's payloads: how many elements, which part, of how many; 255 elements are too many.
Verdict judge(std::size_t, const Header&, std::span<const std::uint8_t> payload) {
  if (payload.size() < 3) return {Reason::too_short};
  if (payload[0] == 255) return {Reason::out_of_range};
  return {Reason::accepted, payload[0], payload[1], payload[2]};
}

/// A listener at the first base port that is free, below the ports Linux lends out: other tests may run beside this
/// one. Moves `streams` there.
std::unique_ptr<Listener> listen(std::vector<StreamPlan>& streams, bool headerless = false,
                                 const Judge& judging = judge) {
  for (std::uint32_t base = 12'000; base < 32'000; base += 200) {
    for (StreamPlan& plan : streams) plan.rule.base = base;
    try {
      return std::make_unique<Listener>(
          ListenerOptions{.headerless = headerless, .streams = streams, .judge = judging});
    } catch (const base::InputError&) {
      continue;  // taken
    }
  }
  throw base::InputError("no 200 free ports between 12000 and 32000");
}

Endpoint port_of(const StreamPlan& plan) {
  return {kLoopback, static_cast<std::uint16_t>(port(plan.rule, plan.robot, plan.sensor))};
}

base::Bytes reading(std::uint32_t robot, std::uint32_t sensor, std::uint32_t sequence, const base::Bytes& payload) {
  base::Bytes bytes;
  frame(
      {.robot = static_cast<std::uint16_t>(robot), .sensor = static_cast<std::uint16_t>(sensor), .sequence = sequence},
      5, payload, bytes);
  return bytes;
}

void send(Outbox& outbox, const StreamPlan& plan, std::uint32_t sequence, const base::Bytes& payload) {
  outbox.queue(port_of(plan), reading(plan.robot, plan.sensor, sequence, payload));
}

void drain(Listener& listener, std::uint64_t until) {
  while (listener.summary().datagrams < until && listener.drain(kPatience) > 0) {
  }
}

TEST(Listener, AThousandPacketsArrive) {
  auto streams = plans(100);
  const auto listener = listen(streams);
  Outbox outbox;
  base::Bytes payload(724, 0);
  payload[0] = 200;
  payload[2] = 1;
  for (std::uint32_t scan = 0; scan < 10; ++scan) {
    for (const StreamPlan& plan : streams) send(outbox, plan, scan, payload);
    outbox.flush();
    drain(*listener, 100 * (scan + 1));
  }
  const Summary sum = listener->summary();
  EXPECT_EQ(outbox.counts().sent, 1000u);
  EXPECT_EQ(outbox.counts().sent_bytes, 748'000u);
  EXPECT_EQ(sum.datagrams, 1000u);
  EXPECT_EQ(sum.good, 1000u);
  EXPECT_EQ(sum.bytes, 748'000u);
  EXPECT_EQ(sum.of.at("sensor").elements, 200'000u);
  EXPECT_EQ(sum.lost + sum.duplicates + sum.reordered + sum.silent_ports, 0u);
  EXPECT_EQ(sum.ports, 100u);
  EXPECT_GT(sum.receive_buffer, 0u);
}

TEST(Listener, RunsUntilSilence) {
  auto streams = plans(1);
  const auto listener = listen(streams);
  Outbox outbox;
  send(outbox, streams[0], 0, {3, 0, 1});
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

TEST(Listener, RunsNoLongerThanItMay) {
  auto streams = plans(1);
  const auto listener = listen(streams);
  const std::atomic<bool> stop = false;
  listener->run(stop, 1'000'000, 1);  // nothing ever comes, and nobody stops it
  EXPECT_EQ(listener->summary().good, 0u);
}

TEST(Listener, ReadingsInSeveralPartsAreCountedByPart) {
  auto streams = plans(1);
  const auto listener = listen(streams);
  Outbox outbox;
  for (const std::uint32_t sequence : {0u, 2u})  // reading 1 never came: three parts
    for (std::uint8_t part = 0; part < 3; ++part) send(outbox, streams[0], sequence, {100, part, 3});
  outbox.flush();
  drain(*listener, 6);
  EXPECT_EQ(listener->summary().good, 6u);
  EXPECT_EQ(listener->summary().lost, 3u);
}

TEST(Listener, WithoutHeadersDatagramsArePayloads) {
  auto streams = plans(1);
  const auto listener = listen(streams, true);
  Outbox outbox;
  for (const base::Bytes& payload : {base::Bytes{3, 0, 1}, {3, 0, 1}, {1}, {255, 0, 1}})
    outbox.queue(port_of(streams[0]), payload);
  outbox.flush();
  drain(*listener, 4);
  const Summary sum = listener->summary();
  EXPECT_EQ(sum.good, 2u);
  EXPECT_EQ(sum.duplicates, 0u);  // nothing tells them apart
  EXPECT_EQ(sum.counts[Reason::too_short], 1u);
  EXPECT_EQ(sum.counts[Reason::out_of_range], 1u);
}

TEST(Listener, KindsAreCountedApart) {
  auto streams = plans(3);
  streams[0].kind = streams[2].kind = "laser";
  streams[1].kind = "magnetometer";
  const auto listener = listen(streams);
  EXPECT_EQ(listener->accept(0, reading(0, 0, 0, {10, 0, 1})), Reason::accepted);
  EXPECT_EQ(listener->accept(1, reading(1, 0, 0, {4, 0, 1})), Reason::accepted);
  EXPECT_EQ(listener->accept(2, reading(2, 0, 0, {20, 0, 1})), Reason::accepted);
  EXPECT_EQ(listener->accept(2, reading(2, 0, 1, {255, 0, 1})), Reason::out_of_range);
  const Summary sum = listener->summary();
  ASSERT_EQ(sum.of.size(), 2u);
  EXPECT_EQ(sum.of.at("laser").good, 2u);
  EXPECT_EQ(sum.of.at("laser").elements, 30u);
  EXPECT_EQ(sum.of.at("magnetometer").good, 1u);
  EXPECT_EQ(sum.of.at("magnetometer").elements, 4u);
}

TEST(Listener, TheJudgeIsToldTheStreamAndTheHeader) {
  auto streams = plans(2);
  std::size_t asked = 99;
  Header told;
  const auto listener = listen(streams, false, [&](std::size_t i, const Header& header, auto) {
    asked = i;
    told = header;
    return Verdict{Reason::out_of_range};
  });
  EXPECT_EQ(listener->accept(1, reading(1, 0, 6, {1})), Reason::out_of_range);
  EXPECT_EQ(asked, 1u);
  EXPECT_EQ(kind_of(told.type), 5);
  EXPECT_EQ(told.robot, 1u);
  EXPECT_EQ(told.sequence, 6u);
}

struct OnePort : testing::Test {
  std::vector<StreamPlan> streams = plans(2);
  std::unique_ptr<Listener> listener = listen(streams);
  Reason say(std::uint32_t robot, std::uint32_t sensor, std::uint32_t sequence, const base::Bytes& payload) {
    return listener->accept(1, reading(robot, sensor, sequence, payload));
  }
};

TEST_F(OnePort, ChecksWhatItCarries) {
  EXPECT_EQ(say(1, 0, 0, {3, 0, 1}), Reason::accepted);
  EXPECT_EQ(say(1, 0, 1, {255, 0, 1}), Reason::out_of_range);  // the judge's word
  EXPECT_EQ(say(1, 0, 2, {}), Reason::too_short);              // likewise
  EXPECT_EQ(say(0, 0, 4, {3, 0, 1}), Reason::wrong_source);    // another robot's
  EXPECT_EQ(say(1, 1, 5, {3, 0, 1}), Reason::wrong_source);    // another sensor's
  EXPECT_EQ(listener->accept(1, v2v_example()), Reason::wrong_direction);
  EXPECT_EQ(listener->accept(1, base::Bytes{1, 2}), Reason::too_short);
  const Summary sum = listener->summary();
  EXPECT_EQ(sum.datagrams, 7u);
  EXPECT_EQ(sum.good, 1u);
  EXPECT_EQ(sum.of.at("sensor").elements, 3u);
  EXPECT_EQ(sum.silent_ports, 1u);
}

TEST_F(OnePort, SeesLossDuplicatesAndReordering) {
  for (const std::uint32_t sequence : {0, 1, 1, 5, 4, 6}) say(1, 0, sequence, {3, 0, 1});
  const Summary sum = listener->summary();
  EXPECT_EQ(sum.good, 6u);
  EXPECT_EQ(sum.duplicates, 1u);
  EXPECT_EQ(sum.reordered, 1u);
  EXPECT_EQ(sum.lost, 2u);
}

TEST(Listener, CollidingPortsAreRefused) {
  std::vector<StreamPlan> streams = plans(2);
  streams.push_back({0, 2, {12'000, 2}});  // sensor 2 runs into robot 1
  EXPECT_THROW(Listener({.streams = streams, .judge = judge}), base::InputError);
}

TEST(Listener, ATakenPortIsRefused) {
  auto streams = plans(1);
  const auto first = listen(streams);
  EXPECT_THROW(Listener({.streams = streams, .judge = judge}), base::InputError);
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

TEST(Listener, WithoutAJudgeIsOurBug) { EXPECT_DEATH(Listener({.streams = {}}), "without a judge"); }

TEST(Outbox, ADatagramLongerThanAnyIsOurBug) {
  Outbox outbox;
  EXPECT_DEATH(outbox.queue({kLoopback, 9}, base::Bytes(kMaxPlain + 1)), " bytes in one datagram");
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
