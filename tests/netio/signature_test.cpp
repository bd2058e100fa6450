#include "netio/signature.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string_view>

#include "tests/netio/documented.h"
#include "tests/netio/examples.h"

namespace sf::netio {
namespace {

using sf::test::documented;

/// 00 01 02 ... 1f
SigningKey counting_key() {
  SigningKey key{};
  std::iota(key.begin(), key.end(), std::uint8_t{0});
  return key;
}

base::Bytes bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

base::Bytes signed_leave(std::uint64_t counter) {
  base::Bytes packet = leave_example();
  sign(packet, counting_key(), counter);
  return packet;
}

/// RFC 4231, test cases 1, 2 and 5; the last one is truncated in the RFC too.
TEST(Hmac, MatchesRfc4231) {
  const auto hmac = [](const base::Bytes& key, std::string_view text) { return hmac_sha256(key, bytes_of(text)); };
  EXPECT_EQ(hmac(base::Bytes(20, 0x0b), "Hi There"), (TruncatedHmac{0xb0, 0x34, 0x4c, 0x61, 0xd8, 0xdb, 0x38, 0x53,
                                                                    0x5c, 0xa8, 0xaf, 0xce, 0xaf, 0x0b, 0xf1, 0x2b}));
  EXPECT_EQ(
      hmac(bytes_of("Jefe"), "what do ya want for nothing?"),
      (TruncatedHmac{0x5b, 0xdc, 0xc1, 0x46, 0xbf, 0x60, 0x75, 0x4e, 0x6a, 0x04, 0x24, 0x26, 0x08, 0x95, 0x75, 0xc7}));
  EXPECT_EQ(
      hmac(base::Bytes(20, 0x0c), "Test With Truncation"),
      (TruncatedHmac{0xa3, 0xb6, 0x16, 0x74, 0x73, 0x10, 0x0e, 0xe0, 0x6e, 0x0c, 0x79, 0x6c, 0x29, 0x55, 0x55, 0x2b}));
}

TEST(Signature, MatchesTheDocumentation) {
  const base::Bytes packet = signed_leave(0x0006'0a24'181e'4000);
  EXPECT_EQ(packet, documented("signed_leave"));
  EXPECT_EQ(SignatureChecker(counting_key()).check(packet), PacketStatus::accepted);
}

/// The trailer does not change the content of a packet of any type.
TEST(Signature, LeavesThePacketReadable) {
  for (const base::Bytes& example : all_examples()) {
    base::Bytes packet = example;
    sign(packet, counting_key(), 1);
    EXPECT_EQ(packet.size(), example.size() + kSignatureBytes);
    Packet plain, read;
    ASSERT_EQ(decode(example, plain), PacketStatus::accepted);
    ASSERT_EQ(decode(packet, read), PacketStatus::accepted) << int{example[5]};
    EXPECT_EQ(read.body.index(), plain.body.index());
    EXPECT_EQ(read.header.sequence, plain.header.sequence);
    EXPECT_EQ(SignatureChecker(counting_key()).check(packet), PacketStatus::accepted) << int{example[5]};
  }
}

TEST(Signature, RejectsEachFlippedBit) {
  for (const base::Bytes& example : all_examples()) {
    base::Bytes packet = example;
    sign(packet, counting_key(), 1'000'000);
    SignatureChecker checker(counting_key());
    for (std::size_t bit = 0; bit < 8 * packet.size(); ++bit) {
      base::Bytes changed = packet;
      changed[bit / 8] = static_cast<std::uint8_t>(changed[bit / 8] ^ 1u << bit % 8);
      const PacketStatus status = checker.check(changed);
      const bool size_bit = bit / 16 == kTrailerAt / 2;
      EXPECT_EQ(status, size_bit ? PacketStatus::not_signed : PacketStatus::wrong_signature) << bit;
    }
    EXPECT_EQ(checker.check(packet), PacketStatus::accepted) << "a rejected counter does not move the window";
  }
}

TEST(Signature, RejectsEveryOtherTrailer) {
  SignatureChecker checker(counting_key());
  EXPECT_EQ(checker.check(leave_example()), PacketStatus::not_signed);
  for (const int size : {0, 23, 25, 80}) {
    const base::Bytes packet = patched(signed_leave(5), kTrailerAt, static_cast<std::uint16_t>(size));
    EXPECT_EQ(checker.check(packet), PacketStatus::not_signed) << size;
  }
  base::Bytes short_packet = patched<std::uint16_t>(leave_example(), kTrailerAt, kSignatureBytes);
  EXPECT_EQ(checker.check(short_packet), PacketStatus::not_signed) << "states a trailer that it does not have";
}

TEST(Signature, AnotherKeyGivesAnotherSignature) {
  SigningKey other = counting_key();
  other[31] ^= 1;
  EXPECT_EQ(SignatureChecker(other).check(signed_leave(5)), PacketStatus::wrong_signature);
}

TEST(Signature, OnlyValidSignaturesAdvanceTheWindow) {
  SignatureChecker checker(counting_key());
  base::Bytes forged = signed_leave(1'000);
  forged.back() ^= 1;
  EXPECT_EQ(checker.check(forged), PacketStatus::wrong_signature);
  EXPECT_EQ(checker.check(signed_leave(5)), PacketStatus::accepted) << "far behind the forged counter";
  EXPECT_EQ(checker.check(signed_leave(5)), PacketStatus::replayed);
}

/// Checks one boundary after another, named in the comments.
TEST(CounterWindow, AdmitsEachCounterOnce) {
  CounterWindow window;
  EXPECT_TRUE(window.admit(100));
  EXPECT_FALSE(window.admit(100)) << "the newest again";
  EXPECT_TRUE(window.admit(99)) << "overtaken by one";
  EXPECT_FALSE(window.admit(99));
  EXPECT_TRUE(window.admit(37)) << "the last in the window: 63 behind";
  EXPECT_FALSE(window.admit(37));
  EXPECT_FALSE(window.admit(36)) << "the first behind it: 64";
  EXPECT_TRUE(window.admit(101)) << "ahead by one: the window moves by one";
  EXPECT_FALSE(window.admit(37)) << "now 64 behind";
  EXPECT_TRUE(window.admit(38)) << "now 63 behind";
  EXPECT_FALSE(window.admit(99));
  EXPECT_TRUE(window.admit(164)) << "ahead by 63: the old newest is the last";
  EXPECT_FALSE(window.admit(101));
  EXPECT_TRUE(window.admit(102));
  EXPECT_TRUE(window.admit(228)) << "ahead by 64: an empty window";
  EXPECT_FALSE(window.admit(164));
  EXPECT_TRUE(window.admit(165));
  EXPECT_TRUE(window.admit(1'000'000)) << "far ahead";
  EXPECT_FALSE(window.admit(228));
}

TEST(CounterWindow, BeginsAtAnyCounter) {
  for (const std::uint64_t first :
       {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{63}, std::uint64_t{64}, ~std::uint64_t{0}}) {
    CounterWindow window;
    EXPECT_TRUE(window.admit(first)) << first;
    EXPECT_FALSE(window.admit(first)) << first;
  }
  CounterWindow window;
  EXPECT_TRUE(window.admit(1));
  EXPECT_TRUE(window.admit(0)) << "0 is a counter like others";
  EXPECT_FALSE(window.admit(0));
}

/// Compares with the rule: new, and less than 64 behind the newest.
TEST(CounterWindow, MatchesItsRule) {
  CounterWindow window;
  std::vector<bool> seen(3000, false);
  std::uint64_t newest = 0, random = 1;
  for (int i = 0; i < 20'000; ++i) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    const std::uint64_t counter = static_cast<std::uint64_t>(i) / 8 + (random >> 33) % 150;
    const bool expected = counter + CounterWindow::kSize > newest && !seen[counter];
    ASSERT_EQ(window.admit(counter), expected) << i;
    if (!expected) continue;
    seen[counter] = true;
    newest = std::max(newest, counter);
  }
}

TEST(PacketSigner, CountsUpFromTheTime) {
  const std::uint64_t before = unix_microseconds();
  PacketSigner signer(counting_key());
  const std::uint64_t first = signer.take();
  EXPECT_GE(first, before);
  EXPECT_EQ(signer.take(10), first + 1);
  EXPECT_EQ(signer.take(), first + 11);
  PacketSigner fixed(counting_key(), 5);
  base::Bytes packet = leave_example();
  fixed.sign(packet);
  EXPECT_EQ(packet, signed_leave(5));
}

}  // namespace
}  // namespace sf::netio
