#include "netio/stream_monitor.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "base/error.h"
#include "base/thread_pool.h"
#include "netio/endpoint.h"
#include "netio/outbox.h"
#include "netio/posix.h"
#include "tests/netio/examples.h"
#include "tests/units.h"

namespace sf::netio {
namespace {

constexpr int kPatience = 5000;  ///< [ms] longest wait for datagrams that loopback already has

constexpr Endpoint kMonitoredFarm{kLoopback, 9000};

/// One sensor on each of `robots`, at two ports per robot.
std::vector<StreamSpec> plans(std::uint32_t robots) {
  std::vector<StreamSpec> streams;
  for (std::uint32_t id = 0; id < robots; ++id) streams.push_back({id, 0, {12'000, 2}});
  return streams;
}

/// Payloads of a test sensor type: number of elements, part, parts; 255 elements are invalid.
PayloadInfo inspect_stream(std::size_t, const Header&, std::span<const std::uint8_t> payload) {
  if (payload.size() < 3) return {PacketStatus::too_short};
  if (payload[0] == 255) return {PacketStatus::out_of_range};
  return {PacketStatus::accepted, payload[0], payload[1], payload[2]};
}

/// Returns a monitor at the first free base port below Linux's ephemeral ports, since other tests run in parallel.
/// Moves `streams` there.
std::unique_ptr<StreamMonitor> listen(std::vector<StreamSpec>& streams,
                                      StreamMonitorOptions options = {.inspect = inspect_stream}) {
  for (std::uint32_t base = 12'000; base < 32'000; base += 200) {
    for (StreamSpec& spec : streams) spec.rule.base = base;
    options.streams = streams;
    try {
      return std::make_unique<StreamMonitor>(options);
    } catch (const base::InputError&) {
      continue;  // taken
    }
  }
  throw base::InputError("no 200 free ports between 12000 and 32000");
}

Endpoint port_of(const StreamSpec& spec) {
  return {kLoopback, static_cast<std::uint16_t>(port(spec.rule, spec.robot, spec.sensor))};
}

base::Bytes reading(std::uint32_t robot, std::uint32_t sensor, std::uint32_t sequence, const base::Bytes& payload) {
  base::Bytes bytes;
  encode_reading(
      {.robot = static_cast<std::uint16_t>(robot), .sensor = static_cast<std::uint16_t>(sensor), .sequence = sequence},
      5, payload, bytes);
  return bytes;
}

void send(Outbox& outbox, const StreamSpec& spec, std::uint32_t sequence, const base::Bytes& payload) {
  outbox.queue(port_of(spec), reading(spec.robot, spec.sensor, sequence, payload));
}

void drain(StreamMonitor& monitor, std::uint64_t until) {
  while (monitor.summary().datagrams < until && monitor.drain(kPatience) > 0) {
  }
}

TEST(StreamMonitor, ReceivesAThousandPackets) {
  auto streams = plans(100);
  const auto monitor = listen(streams);
  Outbox outbox;
  base::Bytes payload(724, 0);
  payload[0] = 200;
  payload[2] = 1;
  for (std::uint32_t scan = 0; scan < 10; ++scan) {
    for (const StreamSpec& spec : streams) send(outbox, spec, scan, payload);
    outbox.flush();
    drain(*monitor, 100 * (scan + 1));
  }
  const StreamSummary sum = monitor->summary();
  EXPECT_EQ(outbox.counts().sent, 1000u);
  EXPECT_EQ(outbox.counts().sent_bytes, 788'000u);
  EXPECT_EQ(sum.datagrams, 1000u);
  EXPECT_EQ(sum.good, 1000u);
  EXPECT_EQ(sum.bytes, 788'000u);
  EXPECT_EQ(sum.of.at("sensor").elements, 200'000u);
  EXPECT_EQ(sum.lost + sum.duplicates + sum.reordered + sum.silent_ports, 0u);
  EXPECT_EQ(sum.ports, 100u);
  EXPECT_GT(sum.receive_buffer, 0u);
}

TEST(StreamMonitor, RunsUntilSilence) {
  auto streams = plans(1);
  const auto monitor = listen(streams);
  Outbox outbox;
  send(outbox, streams[0], 0, {3, 0, 1});
  outbox.flush();
  const std::atomic<bool> stop = false;
  monitor->run(stop, 0);
  EXPECT_EQ(monitor->summary().good, 1u);
}

TEST(StreamMonitor, RunsUntilStopped) {
  auto streams = plans(1);
  const auto monitor = listen(streams);
  std::atomic<bool> stop = false;
  std::thread other([&] { stop = true; });
  monitor->run(stop, 1'000'000);
  other.join();
  EXPECT_EQ(monitor->summary().silent_ports, 1u);
}

TEST(StreamMonitor, RunsUntilItsTimeLimit) {
  auto streams = plans(1);
  const auto monitor = listen(streams);
  const std::atomic<bool> stop = false;
  monitor->run(stop, 1'000'000, 1);  // no datagrams, and `stop` is not set
  EXPECT_EQ(monitor->summary().good, 0u);
}

TEST(StreamMonitor, ReadingsInSeveralPartsAreCountedByPart) {
  auto streams = plans(1);
  const auto monitor = listen(streams);
  Outbox outbox;
  for (const std::uint32_t sequence : {0u, 2u})  // reading 1 is lost: three parts
    for (std::uint8_t part = 0; part < 3; ++part) send(outbox, streams[0], sequence, {100, part, 3});
  outbox.flush();
  drain(*monitor, 6);
  EXPECT_EQ(monitor->summary().good, 6u);
  EXPECT_EQ(monitor->summary().lost, 3u);
}

TEST(StreamMonitor, WithoutHeadersDatagramsArePayloads) {
  auto streams = plans(1);
  const auto monitor = listen(streams, {.headerless = true, .inspect = inspect_stream});
  Outbox outbox;
  for (const base::Bytes& payload : {base::Bytes{3, 0, 1}, {3, 0, 1}, {1}, {255, 0, 1}})
    outbox.queue(port_of(streams[0]), payload);
  outbox.flush();
  drain(*monitor, 4);
  const StreamSummary sum = monitor->summary();
  EXPECT_EQ(sum.good, 2u);
  EXPECT_EQ(sum.duplicates, 0u);  // indistinguishable
  EXPECT_EQ(sum.counts[PacketStatus::too_short], 1u);
  EXPECT_EQ(sum.counts[PacketStatus::out_of_range], 1u);
}

TEST(StreamMonitor, CountsTypesSeparately) {
  auto streams = plans(3);
  streams[0].type = streams[2].type = "laser";
  streams[1].type = "magnetometer";
  const auto monitor = listen(streams);
  EXPECT_EQ(monitor->accept(0, reading(0, 0, 0, {10, 0, 1}), kMonitoredFarm, 0), PacketStatus::accepted);
  EXPECT_EQ(monitor->accept(1, reading(1, 0, 0, {4, 0, 1}), kMonitoredFarm, 0), PacketStatus::accepted);
  EXPECT_EQ(monitor->accept(2, reading(2, 0, 0, {20, 0, 1}), kMonitoredFarm, 0), PacketStatus::accepted);
  EXPECT_EQ(monitor->accept(2, reading(2, 0, 1, {255, 0, 1}), kMonitoredFarm, 0), PacketStatus::out_of_range);
  const StreamSummary sum = monitor->summary();
  ASSERT_EQ(sum.of.size(), 2u);
  EXPECT_EQ(sum.of.at("laser").good, 2u);
  EXPECT_EQ(sum.of.at("laser").elements, 30u);
  EXPECT_EQ(sum.of.at("magnetometer").good, 1u);
  EXPECT_EQ(sum.of.at("magnetometer").elements, 4u);
}

TEST(StreamMonitor, InspectorReceivesStreamAndHeader) {
  auto streams = plans(2);
  std::size_t asked = 99;
  Header inspected;
  const auto monitor = listen(streams, {.inspect = [&](std::size_t i, const Header& header, auto) {
                                asked = i;
                                inspected = header;
                                return PayloadInfo{PacketStatus::out_of_range};
                              }});
  EXPECT_EQ(monitor->accept(1, reading(1, 0, 6, {1}), kMonitoredFarm, 0), PacketStatus::out_of_range);
  EXPECT_EQ(asked, 1u);
  EXPECT_EQ(sensor_type_of(inspected.type), 5);
  EXPECT_EQ(inspected.robot, 1u);
  EXPECT_EQ(inspected.sequence, 6u);
}

struct OnePort : testing::Test {
  std::vector<StreamSpec> streams = plans(2);
  std::unique_ptr<StreamMonitor> monitor = listen(streams);
  PacketStatus feed(std::uint32_t robot, std::uint32_t sensor, std::uint32_t sequence, const base::Bytes& payload) {
    return monitor->accept(1, reading(robot, sensor, sequence, payload), kMonitoredFarm, 0);
  }
};

TEST_F(OnePort, ChecksPayloads) {
  EXPECT_EQ(feed(1, 0, 0, {3, 0, 1}), PacketStatus::accepted);
  EXPECT_EQ(feed(1, 0, 1, {255, 0, 1}), PacketStatus::out_of_range);  // from the inspector
  EXPECT_EQ(feed(1, 0, 2, {}), PacketStatus::too_short);              // the same
  EXPECT_EQ(feed(0, 0, 4, {3, 0, 1}), PacketStatus::wrong_source);    // another robot's
  EXPECT_EQ(feed(1, 1, 5, {3, 0, 1}), PacketStatus::wrong_source);    // another sensor's
  EXPECT_EQ(monitor->accept(1, v2v_example(), kMonitoredFarm, 0), PacketStatus::wrong_direction);
  EXPECT_EQ(monitor->accept(1, base::Bytes{1, 2}, kMonitoredFarm, 0), PacketStatus::too_short);
  const StreamSummary sum = monitor->summary();
  EXPECT_EQ(sum.datagrams, 7u);
  EXPECT_EQ(sum.good, 1u);
  EXPECT_EQ(sum.of.at("sensor").elements, 3u);
  EXPECT_EQ(sum.silent_ports, 1u);
}

TEST_F(OnePort, CountsLossDuplicatesAndReordering) {
  for (const std::uint32_t sequence : {0, 1, 1, 5, 4, 6}) feed(1, 0, sequence, {3, 0, 1});
  const StreamSummary sum = monitor->summary();
  EXPECT_EQ(sum.good, 6u);
  EXPECT_EQ(sum.duplicates, 1u);
  EXPECT_EQ(sum.reordered, 1u);
  EXPECT_EQ(sum.lost, 2u);
}

/// Two farms on one host, or a farm and a forger.
TEST_F(OnePort, AcceptsOneFarmAtATime) {
  const auto from = [&](std::uint32_t session, const Endpoint& who, std::uint32_t sequence, std::int64_t now) {
    base::Bytes bytes = reading(1, 0, sequence, {3, 0, 1});
    write_session_token(bytes, {session, 0});
    return monitor->accept(1, bytes, who, now);
  };
  constexpr Endpoint kOtherHost{kLoopback, 9001};
  EXPECT_EQ(from(1, kMonitoredFarm, 0, 0), PacketStatus::accepted);
  EXPECT_EQ(from(2, kOtherHost, 0, 1), PacketStatus::wrong_source);
  EXPECT_EQ(from(2, kMonitoredFarm, 9, 1), PacketStatus::wrong_source);  // another session from the farm's address
  EXPECT_EQ(from(1, kOtherHost, 9, 1), PacketStatus::wrong_source);      // the farm's session from another address
  EXPECT_EQ(from(1, kMonitoredFarm, 2, 1), PacketStatus::accepted);
  EXPECT_EQ(from(2, kOtherHost, 5, 2 * kSecond), PacketStatus::wrong_source);  // one nanosecond early
  EXPECT_EQ(from(2, kOtherHost, 1, 1 + 2 * kSecond), PacketStatus::accepted);
  EXPECT_EQ(from(1, kMonitoredFarm, 3, 1 + 2 * kSecond), PacketStatus::wrong_source);
  const StreamSummary sum = monitor->summary();
  EXPECT_EQ(sum.good, 3u);
  EXPECT_EQ(sum.lost, 1u) << "1 of the first; nothing before the first packet of the second";
}

TEST_F(OnePort, FaultyPacketDoesNotSelectAFarm) {
  EXPECT_EQ(monitor->accept(1, reading(1, 0, 0, {255, 0, 1}), {kLoopback, 9001}, 0), PacketStatus::out_of_range);
  EXPECT_EQ(feed(1, 0, 0, {3, 0, 1}), PacketStatus::accepted);
}

TEST(StreamMonitor, MayAcceptPacketsOfOneHostOnly) {
  auto streams = plans(1);
  const auto monitor = listen(streams, {.farm = resolve("192.0.2.1"), .inspect = inspect_stream});
  const base::Bytes bytes = reading(0, 0, 0, {3, 0, 1});
  EXPECT_EQ(monitor->accept(0, bytes, kMonitoredFarm, 0), PacketStatus::wrong_source);
  EXPECT_EQ(monitor->accept(0, bytes, {resolve("192.0.2.1"), 1}, 0), PacketStatus::accepted);
}

/// RFC 3550, appendix A.1: a jump is accepted at the second datagram in sequence.
TEST_F(OnePort, RejectsASingleJump) {
  const auto at = [&](std::uint32_t sequence) { return feed(1, 0, sequence, {3, 0, 1}); };
  EXPECT_EQ(at(0), PacketStatus::accepted);
  EXPECT_EQ(at(StreamMonitor::kMaxDropout), PacketStatus::accepted);
  EXPECT_EQ(at(2 * StreamMonitor::kMaxDropout + 1), PacketStatus::out_of_range);
  EXPECT_EQ(at(2 * StreamMonitor::kMaxDropout + 1), PacketStatus::out_of_range);  // duplicated by the network
  EXPECT_EQ(at(StreamMonitor::kMaxDropout + 1), PacketStatus::accepted);          // the old sequence continues
  EXPECT_EQ(monitor->summary().lost, StreamMonitor::kMaxDropout - 1u);
  EXPECT_EQ(at(1'000'000), PacketStatus::out_of_range);
  EXPECT_EQ(at(1'000'001), PacketStatus::accepted);
}

TEST(StreamMonitor, RejectsCollidingPorts) {
  std::vector<StreamSpec> streams = plans(2);
  streams.push_back({0, 2, {12'000, 2}});  // sensor 2 uses a port of robot 1
  EXPECT_THROW(StreamMonitor({.streams = streams, .inspect = inspect_stream}), base::InputError);
}

TEST(StreamMonitor, RejectsAPortInUse) {
  auto streams = plans(1);
  const auto first = listen(streams);
  EXPECT_THROW(StreamMonitor({.streams = streams, .inspect = inspect_stream}), base::InputError);
}

TEST(Outbox, CountsRejectedDatagramsWithTheFirstReason) {
  Outbox outbox;
  outbox.queue({kLoopback, 0}, base::Bytes{1});  // invalid port
  outbox.queue({kLoopback + 1, 0}, base::Bytes{1});
  outbox.queue({kLoopback, 9}, base::Bytes{1});  // no receiver: not an error
  outbox.flush();
  EXPECT_EQ(outbox.counts().queued, 3u);
  EXPECT_EQ(outbox.counts().failed, 2u);
  EXPECT_EQ(outbox.counts().sent, 1u);
  EXPECT_EQ(outbox.counts().dropped, 0u);
  EXPECT_EQ(outbox.counts().first_failure.rfind("127.0.0.1:0: ", 0), 0u) << outbox.counts().first_failure;
}

/// A socket that becomes full: a stream whose other end does not read.
class Full : public testing::Test {
 protected:
  Full()
      : door_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)), full_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in where = to_posix({kLoopback, 0});
    EXPECT_EQ(bind(door_.descriptor(), reinterpret_cast<sockaddr*>(&where), sizeof where), 0);
    EXPECT_EQ(::listen(door_.descriptor(), 1), 0);
    where = to_posix(bound_endpoint(door_));
    const int small = 4096;
    setsockopt(full_.descriptor(), SOL_SOCKET, SO_SNDBUF, &small, sizeof small);
    EXPECT_EQ(connect(full_.descriptor(), reinterpret_cast<sockaddr*>(&where), sizeof where), 0);
  }
  Socket door_, full_;
};
using FullOutbox = Full;

TEST_F(FullOutbox, DropsAndCountsDatagrams) {
  Outbox outbox(std::move(full_), {.capacity = 20'000, .patience_ms = 0});
  for (int i = 0; i < 20'000; ++i) outbox.queue({kLoopback, 9}, base::Bytes(kMaxHeaderlessDatagram));
  outbox.flush();
  const std::uint64_t sent = outbox.counts().sent;
  EXPECT_GT(sent, 0u);
  EXPECT_LT(sent, 20'000u);
  EXPECT_EQ(outbox.counts().dropped, 20'000u - sent);
  outbox.flush();  // dropped datagrams do not wait
  EXPECT_EQ(outbox.counts().sent, sent);
  EXPECT_EQ(outbox.counts().dropped, 20'000u - sent);
  EXPECT_EQ(outbox.counts().failed, 0u);
}

/// A separate thread sends the same datagrams in the same order, even if several threads put them.
TEST(Outbox, SeparateThreadSendsAllInOrder) {
  const Socket sink = open_udp({kLoopback, 0}, {.receive = 8u << 20});
  constexpr std::uint32_t kBatches = 40, kEach = 16;
  {
    Outbox outbox({.capacity = kEach, .backlog = kBatches});
    base::ThreadPool thread_pool(3);
    for (std::uint32_t batch = 0; batch < kBatches; ++batch) {
      const std::size_t first = outbox.claim(kEach);
      thread_pool.parallel_for(kEach, 1, [&](std::size_t begin, std::size_t end, unsigned) {
        for (std::size_t i = begin; i < end; ++i)
          outbox.put(first + i, bound_endpoint(sink), base::Bytes(20, static_cast<std::uint8_t>(batch * kEach + i)));
      });
    }
    outbox.flush();
    const OutboxCounts counts = outbox.counts();
    EXPECT_EQ(counts.queued, kBatches * kEach);
    EXPECT_EQ(counts.sent, kBatches * kEach);
    EXPECT_EQ(counts.sent_bytes, 20u * kBatches * kEach);
    EXPECT_EQ(counts.dropped, 0u);
  }
  ReceiveBatch batch(64);
  std::uint32_t next = 0;
  while (const std::size_t taken = batch.fill(sink))
    for (std::size_t i = 0; i < taken; ++i, ++next) {
      ASSERT_EQ(batch.bytes(i).size(), 20u);
      ASSERT_EQ(batch.bytes(i)[0], static_cast<std::uint8_t>(next));
    }
  EXPECT_EQ(next, kBatches * kEach);
}

/// Blocks only the sending thread. Drops and counts flushes beyond the backlog.
TEST_F(FullOutbox, BacklogIsBounded) {
  Outbox outbox(std::move(full_), {.capacity = 100, .patience_ms = 2, .backlog = 2});
  for (int i = 0; i < 20'000; ++i) outbox.queue({kLoopback, 9}, base::Bytes(kMaxHeaderlessDatagram));
  outbox.flush();
  const OutboxCounts counts = outbox.counts();
  EXPECT_GT(counts.sent, 0u);
  EXPECT_GT(counts.dropped, 0u);
  EXPECT_EQ(counts.queued, 20'000u);
  EXPECT_EQ(counts.sent + counts.dropped, 20'000u);
}

/// Claimed and returned slots are neither sent nor counted.
TEST(Outbox, ReturnedSlotsAreNotSent) {
  const Socket sink = open_udp({kLoopback, 0});
  Outbox outbox;
  outbox.queue(bound_endpoint(sink), base::Bytes{1});
  outbox.claim(5);
  outbox.give_back(5);
  outbox.queue(bound_endpoint(sink), base::Bytes{2});
  outbox.flush();
  EXPECT_EQ(outbox.counts().sent, 2u);
  EXPECT_EQ(outbox.counts().queued, 2u);
}

TEST(Socket, ReportsKernelDrops) {
  const Socket sink = open_udp({kLoopback, 0}, {.receive = 1});  // the minimum of the kernel
  const Endpoint to{kLoopback, bound_endpoint(sink).port};
  EXPECT_EQ(socket_drops(sink), 0u);
  Outbox outbox;
  for (int i = 0; i < 100; ++i) outbox.queue(to, base::Bytes(1000));
  outbox.flush();
  ReceiveBatch batch(64);
  std::size_t taken = 0;
  for (std::size_t n = 1; n > 0; taken += n) n = batch.fill(sink);
  EXPECT_LT(taken, 100u);
  EXPECT_EQ(socket_drops(sink), 100u - taken);
}

TEST(Outbox, FlushesAutomaticallyWhenFull) {
  Outbox outbox({.capacity = 4});
  for (int i = 0; i < 10; ++i) outbox.queue({kLoopback, 9}, base::Bytes{1, 2, 3});
  EXPECT_EQ(outbox.counts().sent, 8u);
  outbox.flush();
  outbox.flush();  // nothing left
  EXPECT_EQ(outbox.counts().sent, 10u);
  EXPECT_EQ(outbox.counts().sent_bytes, 30u);
}

TEST(StreamMonitor, AbortsWithoutAnInspector) { EXPECT_DEATH(StreamMonitor({.streams = {}}), "without a judge"); }

TEST(Outbox, AbortsOnTooLongADatagram) {
  Outbox outbox;
  EXPECT_DEATH(outbox.queue({kLoopback, 9}, base::Bytes(kMaxHeaderlessDatagram + 1)), " bytes in one datagram");
}

TEST(Endpoint, ResolvesAndPrints) {
  EXPECT_EQ(resolve("127.0.0.1"), kLoopback);
  EXPECT_EQ(endpoint_text(Endpoint{0xC0000201u, 10008}), "192.0.2.1:10008");
  EXPECT_THROW(resolve("no host has a space"), base::InputError);
}

TEST(Endpoint, LoopbackIncludesItsWholeNetwork) {
  for (const std::uint32_t address : {0x7F000000u, kLoopback, 0x7FFFFFFFu}) EXPECT_TRUE(is_loopback(address));
  for (const std::uint32_t address : {0u, 0x7EFFFFFFu, 0x80000000u}) EXPECT_FALSE(is_loopback(address));
  for (const std::uint32_t address : own_addresses()) EXPECT_FALSE(is_loopback(address)) << ipv4_text(address);
}

TEST(Endpoint, OwnAddressesIncludeTheSourceOfARoute) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM, 0);
  const sockaddr_in other = to_posix({0xCB007101u, 9});  // for documentation; nothing is sent
  sockaddr_in own{};
  socklen_t size = sizeof(own);
  const bool has_route = ::connect(socket, reinterpret_cast<const sockaddr*>(&other), sizeof(other)) == 0 &&
                         ::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &size) == 0;
  ::close(socket);
  const std::uint32_t source = from_posix(own).address;
  if (!has_route || is_loopback(source)) GTEST_SKIP() << "this machine has no route to others";
  EXPECT_EQ(std::ranges::count(own_addresses(), source), 1);
}

/// Runs in a separate process, since the limit applies to the whole process.
TEST(Socket, RaisesButNeverLowersTheOpenFileLimit) {
  const auto try_limits = [] {
    rlimit before{}, after{};
    getrlimit(RLIMIT_NOFILE, &before);
    raise_open_file_limit(1);
    getrlimit(RLIMIT_NOFILE, &after);
    bool fine = after.rlim_cur == before.rlim_cur;
    before.rlim_cur = std::min<rlim_t>(64, before.rlim_max);
    setrlimit(RLIMIT_NOFILE, &before);
    raise_open_file_limit(65);
    getrlimit(RLIMIT_NOFILE, &after);
    fine = fine && after.rlim_cur == 65 && after.rlim_max == before.rlim_max;
    before.rlim_max = after.rlim_cur;
    setrlimit(RLIMIT_NOFILE, &before);  // lowers the hard limit, too
    try {
      raise_open_file_limit(66);
      fine = false;
    } catch (const base::InputError& error) {
      fine = fine && std::string(error.what()).find("66 open files are required") != std::string::npos;
    }
    std::exit(fine ? 0 : 1);
  };
  EXPECT_EXIT(try_limits(), testing::ExitedWithCode(0), "");
}

TEST(Endpoint, ResolvesNames) {
  if (access("/etc/hosts", R_OK) != 0) GTEST_SKIP() << "this machine has no /etc/hosts, so it need not know localhost";
  EXPECT_EQ(resolve("localhost"), kLoopback);
}

}  // namespace
}  // namespace sf::netio
