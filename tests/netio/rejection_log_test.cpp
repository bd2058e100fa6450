#include "netio/rejection_log.h"

#include <gtest/gtest.h>

#include <string>

#include "base/time.h"
#include "netio/packet_forms.h"
#include "netio/packets.h"
#include "tests/netio/log_pipe.h"
#include "tests/units.h"

namespace sf::netio {
namespace {

base::Bytes v2v(std::uint16_t robot = 7) {
  base::Bytes bytes;
  encode({.robot = robot}, V2v{}, bytes);
  return bytes;
}

const std::vector<std::uint32_t> kRobots{1, 2};

TEST(RejectionText, NamesTheFaultAndTheRemedy) {
  base::Bytes bytes = v2v();
  bytes.resize(bytes.size() - 4);
  EXPECT_EQ(rejection_text(PacketStatus::too_short, bytes, kRobots),
            "a V2V of 128 bytes is too short: expected 132 or 148");
  bytes.resize(140);
  EXPECT_EQ(rejection_text(PacketStatus::too_long, bytes, kRobots),
            "a V2V of 140 bytes is too long: expected 132 or 148");
  EXPECT_EQ(rejection_text(PacketStatus::too_short, std::span(bytes).first(3), kRobots),
            "3 bytes: every packet starts with a header of 64 bytes");
  EXPECT_EQ(rejection_text(PacketStatus::unknown_robot, v2v(), kRobots),
            "the world has no robot with id 7; it has 1, 2");
  EXPECT_EQ(rejection_text(PacketStatus::unknown_robot, v2v(300), {}),
            "the world has no robot with id 300; it has none");
  bytes[kVersionAt] = 1;
  EXPECT_EQ(rejection_text(PacketStatus::unknown_version, bytes, kRobots),
            "protocol version 1: expected 2; update the sender");
}

/// Includes packets of processes in lockstep.
TEST(RejectionText, NamesEveryType) {
  base::Bytes bytes = v2v();
  bytes[kTypeAt] = static_cast<std::uint8_t>(Type::step);
  bytes.resize(kHeaderBytes + 15);
  EXPECT_EQ(rejection_text(PacketStatus::too_short, bytes, kRobots), "a STEP of 79 bytes is too short: expected 80");
  bytes[kTypeAt] = static_cast<std::uint8_t>(Type::command);
  EXPECT_EQ(rejection_text(PacketStatus::too_short, bytes, kRobots), "a COMMAND of 79 bytes is too short")
      << "its size depends on its rows";
}

/// The decoder accepts all types of the table, with the sizes in the table.
TEST(PacketForms, MatchTheDecoder) {
  int forms = 0;
  for (int number = 0; number < 256; ++number) {
    const auto type = static_cast<Type>(number);
    const PacketForm* const form = find_packet_form(type);
    base::Bytes bytes = v2v();
    bytes[kTypeAt] = static_cast<std::uint8_t>(number);
    bytes.resize(form != nullptr && form->bytes > 0 ? form->bytes : kHeaderBytes);
    const auto status = [&](std::size_t size) {
      Packet packet;
      bytes.resize(size);
      return decode(bytes, packet);
    };
    EXPECT_EQ(form == nullptr && sensor_type_of(type) == 0, status(bytes.size()) == PacketStatus::unknown_type)
        << number;
    if (form == nullptr) continue;
    ++forms;
    EXPECT_EQ(form->type, type);
    if (form->bytes == 0) continue;
    const PacketStatus right = status(form->bytes);
    EXPECT_TRUE(right != PacketStatus::too_short && right != PacketStatus::too_long)
        << form->name << ": " << name(right);
    EXPECT_EQ(status(form->bytes + 1), PacketStatus::too_long) << form->name;
    EXPECT_EQ(status(form->bytes - 1), PacketStatus::too_short) << form->name;
  }
  EXPECT_EQ(forms, 20);
}

// Every reason that no other log reports has its own text.
TEST(RejectionText, EveryReasonHasAText) {
  const base::Bytes bytes = v2v();
  for (auto i = static_cast<int>(PacketStatus::too_short); i <= static_cast<int>(PacketStatus::unknown_light); ++i) {
    const auto reason = static_cast<PacketStatus>(i);
    EXPECT_NE(rejection_text(reason, bytes, kRobots), name(reason)) << name(reason);
  }
}

struct Fixture {
  explicit Fixture() : rejections(kRobots) {}
  void note(PacketStatus reason, std::uint16_t port, std::int64_t now) {
    rejections.note(reason, bytes, {kLoopback, port}, now, log);
  }
  base::Bytes bytes = v2v();
  LogPipe pipe;
  RateLimitedLog log{pipe.descriptor()};
  RejectionLog rejections;
};

TEST(RejectionLog, LogsEachSenderOnceThenCountsEveryTenSeconds) {
  Fixture f;
  for (int i = 0; i < 5; ++i) f.note(PacketStatus::unknown_robot, 4000, i);
  f.note(PacketStatus::unknown_robot, 4001, 5);
  f.note(PacketStatus::out_of_range, 4000, 6);
  EXPECT_EQ(f.pipe.read_all(),
            "sensorfarm: 1 packet from 127.0.0.1:4000 dropped: the world has no robot with id 7; it has 1, 2 "
            "(docs/packets.md)\n"
            "sensorfarm: 1 packet from 127.0.0.1:4001 dropped: the world has no robot with id 7; it has 1, 2 "
            "(docs/packets.md)\n"
            "sensorfarm: 1 packet from 127.0.0.1:4000 dropped: a number in it is out of range (docs/packets.md)\n");
  f.note(PacketStatus::unknown_robot, 4000, 10 * kSecond - 1);
  EXPECT_EQ(f.pipe.read_all(), "");
  f.note(PacketStatus::unknown_robot, 4000, 10 * kSecond);
  EXPECT_NE(f.pipe.read_all().find("6 packets from 127.0.0.1:4000"), std::string::npos);
}

// A client's first packet has no token, and networks reorder packets, so a few of either are normal.
TEST(RejectionLog, ToleratesAFewUnprovenAndStalePackets) {
  for (const PacketStatus reason : {PacketStatus::unproven, PacketStatus::stale}) {
    Fixture f;
    for (unsigned i = 0; i < RejectionLog::kTolerated - 1; ++i) f.note(reason, 4000, kSecond);
    EXPECT_EQ(f.pipe.read_all(), "");
    f.note(reason, 4000, 11 * kSecond + 1);
    EXPECT_EQ(f.pipe.read_all(), "") << "ten seconds later counts begin again";
    for (unsigned i = 0; i < RejectionLog::kTolerated - 1; ++i) f.note(reason, 4000, 12 * kSecond);
    EXPECT_NE(f.pipe.read_all().find("20 packets from"), std::string::npos);
  }
}

// Other logs report these.
TEST(RejectionLog, IgnoresSignaturesAndSources) {
  Fixture f;
  for (const PacketStatus reason : {PacketStatus::accepted, PacketStatus::not_signed, PacketStatus::wrong_signature,
                                    PacketStatus::replayed, PacketStatus::wrong_source})
    f.note(reason, 4000, 0);
  EXPECT_EQ(f.pipe.read_all(), "");
}

TEST(RejectionLog, SendersBeyondItsLimitShareOneRow) {
  Fixture f;
  for (unsigned i = 0; i < 1000; ++i) f.note(PacketStatus::bad_magic, static_cast<std::uint16_t>(4000 + i), kSecond);
  f.pipe.read_all();
  f.note(PacketStatus::bad_magic, 9000, 11 * kSecond);
  const std::string text = f.pipe.read_all();
  EXPECT_NE(text.find("packets from 127.0.0.1:9000 and other senders dropped"), std::string::npos) << text;
  // Silent senders free their rows.
  f.note(PacketStatus::bad_magic, 9001, 12 * kSecond);
  EXPECT_NE(f.pipe.read_all().find("1 packet from 127.0.0.1:9001 dropped"), std::string::npos);
}

}  // namespace
}  // namespace sf::netio
