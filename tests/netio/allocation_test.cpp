// Receiving and sending allocate nothing after construction. This program counts calls of `new`.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "netio/inbox.h"
#include "netio/outbox.h"
#include "netio/relay.h"
#include "tests/netio/examples.h"

namespace {

std::atomic<std::uint64_t> allocations = 0;

}  // namespace

void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size > 0 ? size : 1);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return operator new(size, std::nothrow); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, const std::nothrow_t&) noexcept { std::free(memory); }

namespace sf::netio {
namespace {

base::Bytes subscribe_to_others(std::uint32_t token) {
  base::Bytes bytes;
  encode({.robot = 7, .sequence = 1, .session = 1, .token = token}, Subscribe{kNeighboursBit}, bytes);
  return bytes;
}

base::Bytes state_of_another(std::uint32_t token) {
  base::Bytes bytes;
  encode({.robot = 9, .session = 1, .token = token}, V2v{}, bytes);
  return bytes;
}

TEST(Allocation, NoneWhenReceivingOrSending) {
  Inbox inbox({.bind = {kLoopback, 0}, .robots = {7, 9}, .tags = {12}, .lights = {2}});
  Relay relay(std::vector<std::uint32_t>{7, 9}, {}, std::vector<std::uint32_t>{2});
  Outbox answers(inbox.socket());
  Outbox outbox;
  const Endpoint to{kLoopback, inbox.port()};
  const base::Bytes payload(kMaxPayload, 5);
  base::Bytes framed;
  framed.reserve(kMaxDatagram);
  std::vector<base::Bytes> packets = examples();
  const std::uint32_t token = inbox.token({kLoopback, outbox.endpoint().port});
  for (base::Bytes& packet : packets) write_session_token(packet, {1, token});
  const base::Bytes own_readings = packets[packets.size() - 2];
  packets.resize(packets.size() - 7);  // those from the farm, like the challenge, and TEAM_MAP
  const std::vector<base::Bytes> fixed(packets.end() - 2, packets.end());  // a light and an object
  packets.resize(packets.size() - 3);
  const base::Bytes leave = packets.back();  // after it the robot receives no packets
  packets.back() = subscribe_to_others(token);
  packets.push_back(state_of_another(token));
  packets.insert(packets.end(), fixed.begin(), fixed.end());
  packets.push_back(own_readings);
  base::Bytes answer;
  answer.reserve(kMaxDatagram);
  Packet unproven;
  decode(v2v_example(), unproven);

  const std::uint64_t before = allocations;
  std::size_t taken = 0;
  for (int round = 0; round < 20; ++round) {
    for (const base::Bytes& packet : packets) outbox.queue(to, packet);
    encode_reading({.robot = 7}, 1, payload, framed);
    outbox.queue(to, framed);
    outbox.flush();
    taken += inbox.receive(round, [&](const Packet& packet) { relay.take(packet); });
    relay.forward(inbox, round, answers);
    inbox.challenge(unproven, to, round, answer);
    answers.flush();
  }
  outbox.queue(to, leave);
  outbox.flush();
  taken += inbox.receive(20, [&](const Packet& packet) { relay.take(packet); });
  relay.forward(inbox, 20, answers);
  EXPECT_EQ(allocations - before, 0u);
  EXPECT_GT(taken, 0u);
  EXPECT_GT(relay.counts().starts, 0u);
  EXPECT_GT(relay.counts().states, 0u);
  EXPECT_EQ(outbox.counts().sent, 20u * 12u + 1u);
}

}  // namespace
}  // namespace sf::netio
