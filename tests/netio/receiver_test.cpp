#include "netio/receiver.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/netio/examples.h"

namespace sf::netio {
namespace {

/// Payloads of a test sensor type: part, parts, then one byte with the part's number; 255 is invalid.
PayloadInfo inspect(std::size_t, const Header&, std::span<const std::uint8_t> payload) {
  if (payload.size() < 3) return {PacketStatus::too_short};
  if (payload.size() > 3) return {PacketStatus::too_long};
  if (payload[2] == 255 || payload[1] != 2 || payload[0] >= 2) return {PacketStatus::out_of_range};
  return {PacketStatus::accepted, 1, payload[0], payload[1]};
}

void read(std::size_t stream, const Header&, std::span<const std::uint8_t> payload, std::span<double> values) {
  values[payload[0]] = 1000.0 * static_cast<double>(stream) + payload[2];
}

ReceiverOptions receiver_options(bool headerless = false) {
  return {.streams = {{{.robot = 7, .sensor = 0}, 2}, {{.robot = 7, .sensor = 1}, 2}},
          .headerless = headerless,
          .inspect = inspect,
          .read = read};
}

base::Bytes part(std::uint16_t sensor, std::uint32_t sequence, std::uint8_t number, std::uint8_t value) {
  base::Bytes bytes;
  const std::uint8_t payload[] = {number, 2, value};
  encode_reading({.robot = 7, .sensor = sensor, .sequence = sequence, .time = 1000 + std::int64_t{sequence}}, 5,
                 payload, bytes);
  return bytes;
}

TEST(Receiver, ReturnsTheNewestCompleteReadingOfEachSensor) {
  Receiver receiver(receiver_options());
  EXPECT_FALSE(receiver.newest(0));
  EXPECT_EQ(receiver.accept(0, part(0, 4, 1, 11), 5), PartStatus::incomplete);
  EXPECT_EQ(receiver.accept(0, part(0, 4, 0, 10), 6), PartStatus::complete);
  EXPECT_EQ(receiver.accept(1, part(1, 9, 0, 20), 7), PartStatus::incomplete);
  const auto whole = receiver.newest(0);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->time, 1004);
  EXPECT_EQ(whole->arrival, 6);
  EXPECT_EQ(whole->values[0], 10.0);
  EXPECT_EQ(whole->values[1], 11.0);
  EXPECT_FALSE(receiver.newest(1));
}

/// Each port has its own counters: the second port's are far behind the first's when its packets are read.
TEST(Receiver, RequiresSignaturesWithAKey) {
  constexpr SigningKey kReceiverKey{1};
  ReceiverOptions chosen = receiver_options();
  chosen.key = kReceiverKey;
  Receiver receiver(chosen);
  receiver.set_session({11, 22});
  const auto take = [&](std::uint16_t sensor, std::uint8_t number, std::uint64_t counter, std::uint32_t session = 11) {
    base::Bytes bytes = part(sensor, 4, number, 1);
    write_session_token(bytes, {session, 22});
    if (counter > 0) sign(bytes, kReceiverKey, counter);
    return receiver.accept(sensor, bytes, 0);
  };
  EXPECT_EQ(take(0, 0, 0), PartStatus::rejected);
  EXPECT_EQ(take(0, 0, 5'000, 12), PartStatus::rejected) << "another session does not move the window";
  EXPECT_EQ(take(0, 0, 1'000), PartStatus::incomplete);
  EXPECT_EQ(take(0, 1, 1'000), PartStatus::rejected);
  EXPECT_EQ(take(0, 1, 1'001), PartStatus::complete);
  EXPECT_EQ(take(1, 0, 1), PartStatus::incomplete);
  const PacketCounts counts = receiver.counts().packets;
  EXPECT_EQ(counts[PacketStatus::not_signed], 1u);
  EXPECT_EQ(counts[PacketStatus::wrong_source], 1u);
  EXPECT_EQ(counts[PacketStatus::replayed], 1u);
}

TEST(Receiver, CountsUnusedDatagrams) {
  Receiver receiver(receiver_options());
  EXPECT_EQ(receiver.accept(0, part(1, 4, 0, 1), 0), PartStatus::rejected);  // another sensor's port
  EXPECT_EQ(receiver.accept(0, v2v_example(), 0), PartStatus::rejected);
  EXPECT_EQ(receiver.accept(0, part(0, 4, 0, 255), 0), PartStatus::rejected);
  receiver.accept(0, part(0, 4, 0, 1), 0);
  EXPECT_EQ(receiver.accept(0, part(0, 4, 0, 1), 0), PartStatus::duplicate);
  receiver.accept(0, part(0, 4, 1, 1), 0);
  EXPECT_EQ(receiver.accept(0, part(0, 3, 1, 1), 0), PartStatus::late);
  receiver.accept(0, part(0, 6, 1, 1), 0);
  const ReceiverCounts counts = receiver.counts();
  EXPECT_EQ(counts.packets[PacketStatus::wrong_source], 1u);
  EXPECT_EQ(counts.packets[PacketStatus::wrong_direction], 1u);
  EXPECT_EQ(counts.packets[PacketStatus::out_of_range], 1u);
  EXPECT_EQ(counts.packets[PacketStatus::accepted], 5u);
  EXPECT_EQ(counts.duplicates, 1u);
  EXPECT_EQ(counts.late, 1u);
  EXPECT_EQ(counts.lost, 3u);  // both parts of 5, one of 6
}

TEST(Receiver, HeaderlessReadingsCountInOrderOfArrival) {
  ReceiverOptions plain = receiver_options(true);
  plain.inspect = [](std::size_t, const Header&, std::span<const std::uint8_t> payload) -> PayloadInfo {
    return {payload.size() == 1 ? PacketStatus::accepted : PacketStatus::too_short, 1, 0, 1};
  };
  plain.read = [](std::size_t, const Header&, std::span<const std::uint8_t> payload, std::span<double> values) {
    values[0] = payload[0];
  };
  Receiver receiver(plain);
  EXPECT_EQ(receiver.accept(0, base::Bytes{}, 5), PartStatus::rejected);
  std::int64_t now = 9;
  for (const std::uint8_t value : base::Bytes{3, 1, 2})
    EXPECT_EQ(receiver.accept(0, base::Bytes{value}, ++now), PartStatus::complete);
  EXPECT_EQ(receiver.newest(0)->values[0], 2.0);
  EXPECT_EQ(receiver.newest(0)->time, 12);  // headerless payloads have no time
  EXPECT_EQ(receiver.newest(0)->sequence, 2u);
}

TEST(Receiver, HeaderlessPartsBelongToThePrecedingReading) {
  Receiver receiver(receiver_options(true));
  const auto send = [&](std::uint8_t part, std::uint8_t value, std::int64_t now) {
    return receiver.accept(0, base::Bytes{part, 2, value}, now);
  };
  EXPECT_EQ(send(0, 10, 5), PartStatus::incomplete);
  ASSERT_EQ(send(1, 11, 6), PartStatus::complete);
  EXPECT_EQ(receiver.newest(0)->time, 5);
  EXPECT_EQ(send(0, 20, 7), PartStatus::incomplete);  // its second part is lost
  EXPECT_EQ(send(0, 30, 8), PartStatus::incomplete);
  ASSERT_EQ(send(1, 31, 9), PartStatus::complete);
  EXPECT_EQ(receiver.newest(0)->values[0], 30.0);
  EXPECT_EQ(receiver.newest(0)->values[1], 31.0);
}

TEST(Receiver, AMillionRandomAndMutatedDatagrams) {
  std::mt19937 random(20260102);  // NOLINT: the same datagrams every time
  Receiver receiver(receiver_options());
  base::Bytes bytes;
  std::uint64_t wholes = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    const auto sensor = static_cast<std::uint16_t>(random() % 2);
    const auto sequence = static_cast<std::uint32_t>(i / 8) + static_cast<std::uint32_t>(random() % 6);
    bytes = part(sensor, sequence, static_cast<std::uint8_t>(random() % 2), static_cast<std::uint8_t>(random()));
    for (auto edits = random() % 3; edits > 0; --edits)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (random() % 16 == 0) bytes.resize(random() % 64);
    const auto now = std::int64_t{i} * 1'000'000;
    wholes += receiver.accept(random() % 2, bytes, now) == PartStatus::complete;
  }
  EXPECT_EQ(receiver.counts().packets.total(), 1'000'000u);
  EXPECT_GT(wholes, 1000u);
  EXPECT_GT(receiver.counts().late, 0u);
  EXPECT_GT(receiver.counts().duplicates, 0u);
}

/// A receiver with a session accepts packets with its farm's session and its own.
TEST(Receiver, AcceptsOnlyPacketsOfItsFarm) {
  const auto from = [](const SessionToken& farm, std::uint32_t sequence, std::uint8_t number) {
    base::Bytes bytes = part(0, sequence, number, 1);
    write_session_token(bytes, farm);
    return bytes;
  };
  constexpr SessionToken kReceivedFarm{0xFA23, 7}, kForged{0xFA23, 8}, kOther{0xFA24, 7};
  Receiver receiver(receiver_options());
  receiver.set_session({0, 7});  // before any challenge
  receiver.set_session(kReceivedFarm);
  EXPECT_EQ(receiver.counts().restarts, 0u);
  EXPECT_EQ(receiver.accept(0, from(kReceivedFarm, 100, 0), 0), PartStatus::incomplete);
  EXPECT_EQ(receiver.accept(0, from(kForged, 100, 1), 0), PartStatus::rejected);
  EXPECT_EQ(receiver.accept(0, from(kOther, 100, 1), 0), PartStatus::rejected);
  EXPECT_EQ(receiver.accept(0, from(kReceivedFarm, 100, 1), 0), PartStatus::complete);
  receiver.reject_source();
  EXPECT_EQ(receiver.counts().packets[PacketStatus::wrong_source], 3u);
  receiver.set_session(kReceivedFarm);  // a repeated challenge changes nothing
  EXPECT_TRUE(receiver.newest(0));
  // The farm has restarted and counts from 0.
  receiver.set_session(kOther);
  EXPECT_FALSE(receiver.newest(0));
  EXPECT_EQ(receiver.accept(0, from(kOther, 0, 0), 1), PartStatus::incomplete);
  EXPECT_EQ(receiver.accept(0, from(kOther, 0, 1), 1), PartStatus::complete);
  EXPECT_EQ(receiver.accept(0, from(kReceivedFarm, 101, 0), 1), PartStatus::rejected);
  EXPECT_EQ(receiver.counts().restarts, 2u);  // of two streams
}

TEST(Receiver, CountsJumps) {
  Receiver receiver(receiver_options());
  for (const std::uint8_t number : {std::uint8_t{0}, std::uint8_t{1}}) receiver.accept(0, part(0, 5, number, 1), 0);
  EXPECT_EQ(receiver.accept(0, part(0, 50'000, 0, 1), 0), PartStatus::jump);
  EXPECT_EQ(receiver.counts().jumps, 1u);
  EXPECT_EQ(receiver.counts().late, 0u);
}

}  // namespace
}  // namespace sf::netio
