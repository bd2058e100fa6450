#include "robots/arcos.h"

#include <gtest/gtest.h>

#include <random>

namespace sf::robots {
namespace {

// Player's and ARIA's byte sequences.
TEST(Arcos, EncodesCommandsAsSpecified) {
  EXPECT_EQ(arcos_sync(0), (base::Bytes{0xFA, 0xFB, 3, 0, 0, 0}));
  EXPECT_EQ(arcos_sync(1), (base::Bytes{0xFA, 0xFB, 3, 1, 0, 1}));
  EXPECT_EQ(arcos_sync(2), (base::Bytes{0xFA, 0xFB, 3, 2, 0, 2}));
  EXPECT_EQ(arcos_command(ArcosCommand::enable, 1), (base::Bytes{0xFA, 0xFB, 6, 4, 0x3B, 1, 0, 5, 0x3B}));
  EXPECT_EQ(arcos_command(ArcosCommand::vel, 500), (base::Bytes{0xFA, 0xFB, 6, 11, 0x3B, 0xF4, 0x01, 0xFF, 0x3C}));
  EXPECT_EQ(arcos_command(ArcosCommand::vel, -500), (base::Bytes{0xFA, 0xFB, 6, 11, 0x1B, 0xF4, 0x01, 0xFF, 0x1C}))
      << "the amount, with another type";
}

const base::Bytes kPayload{0x32, 1, 2, 3};

TEST(ArcosStream, FindsAPacketAtAnyCut) {
  const base::Bytes packet = arcos_packet(kPayload);
  for (std::size_t cut = 0; cut <= packet.size(); ++cut) {
    ArcosStream stream;
    stream.add(std::span(packet).first(cut));
    EXPECT_EQ(stream.next().has_value(), cut == packet.size());
    stream.add(std::span(packet).subspan(cut));
    EXPECT_EQ(stream.next().value_or(kPayload), kPayload) << cut;
    EXPECT_EQ(stream.frames(), 1u);
  }
}

TEST(ArcosStream, RecoversAfterALostByte) {
  const base::Bytes packet = arcos_packet(kPayload);
  for (std::size_t lost = 0; lost < packet.size(); ++lost) {
    ArcosStream stream;
    base::Bytes bytes = packet;
    bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(lost));
    stream.add(bytes);
    // A lost length makes the next byte the length: more packets fill that one.
    for (int k = 0; k < 40; ++k) stream.add(packet);
    std::size_t whole = 0;
    while (const auto payload = stream.next()) whole += *payload == kPayload;
    EXPECT_EQ(whole, 40u) << lost;
    EXPECT_EQ(stream.skipped(), packet.size() - 1) << lost;
  }
}

TEST(ArcosStream, AcceptsAnyBytes) {
  ArcosStream stream;
  std::mt19937 random(7);
  std::uint64_t bytes = 0;
  for (; bytes < 100'000; ++bytes) {
    const std::uint8_t byte[] = {static_cast<std::uint8_t>(random() % 3 == 0 ? 0xFA + random() % 2 : random() % 256)};
    stream.add(byte);
    while (const auto payload = stream.next()) {
      parse_arcos_sip(*payload);
      parse_arcos_name(*payload);
    }
  }
  EXPECT_LE(stream.skipped(), bytes);
  for (int k = 0; k < 40; ++k) stream.add(arcos_packet(kPayload));
  std::size_t whole = 0;
  while (const auto payload = stream.next()) whole += *payload == kPayload;
  EXPECT_EQ(whole, 40u);
}

TEST(Arcos, RejectsShortPackets) {
  base::Bytes payload(25, 0);
  payload[0] = 0x32;
  EXPECT_TRUE(parse_arcos_sip(payload));
  payload[19] = 2;
  EXPECT_FALSE(parse_arcos_sip(payload)) << "two ranges need six bytes";
  payload.resize(26);
  EXPECT_TRUE(parse_arcos_sip(payload));
  payload[0] = 0x90;
  EXPECT_FALSE(parse_arcos_sip(payload)) << "another packet";
  EXPECT_FALSE(parse_arcos_sip(std::span(payload).first(19)));
}

TEST(Arcos, ReadsTheNamesOfARobot) {
  const std::string names{"\x02lab\0Pioneer\0P3AT-SH\0", 21};
  const auto name = parse_arcos_name(std::span(reinterpret_cast<const std::uint8_t*>(names.data()), names.size()));
  ASSERT_TRUE(name);
  EXPECT_EQ(name->name, "lab");
  EXPECT_EQ(name->type, "Pioneer");
  EXPECT_EQ(name->subtype, "p3at-sh");
  EXPECT_EQ(name->distance, 1e-3);
  const base::Bytes cut{2, 'a'};
  EXPECT_EQ(parse_arcos_name(cut)->name, "a");
}

}  // namespace
}  // namespace sf::robots
