#include "v2x/bit_stream.h"

#include <gtest/gtest.h>

#include <random>

namespace sf::v2x {

namespace {

base::Bytes octets(std::size_t count) {
  base::Bytes all(count);
  for (std::size_t i = 0; i < count; ++i) all[i] = static_cast<std::uint8_t>(i * 7 + i / 251);
  return all;
}

}  // namespace

TEST(BitStream, MostSignificantBitFirst) {
  base::Bytes bytes;
  BitWriter out(bytes);
  out.put(0b101, 3);
  out.put(0b0, 1);
  out.put(0xABC, 12);
  EXPECT_EQ(bytes, (base::Bytes{0xAA, 0xBC}));
  BitReader in(bytes);
  EXPECT_EQ(in.bits(3), 0b101u);
  EXPECT_EQ(in.bits(13), 0xABCu);
  EXPECT_EQ(in.left(), 0u);
  EXPECT_TRUE(in.good());
}

TEST(BitStream, NumbersOfEveryWidthRoundTrip) {
  std::mt19937_64 random(1);
  for (unsigned offset = 0; offset < 8; ++offset) {
    base::Bytes bytes;
    BitWriter out(bytes);
    out.put(0, offset);
    std::vector<std::uint64_t> numbers;
    for (unsigned width = 0; width <= 64; ++width) {
      numbers.push_back(width == 0 ? 0 : random() >> (64 - width));
      out.put(numbers.back(), width);
    }
    BitReader in(bytes);
    in.bits(offset);
    for (unsigned width = 0; width <= 64; ++width) EXPECT_EQ(in.bits(width), numbers[width]) << width;
    EXPECT_TRUE(in.good());
  }
}

TEST(BitStream, ReadingBeyondTheEndIsAPermanentFault) {
  const base::Bytes bytes{0xFF, 0xFF};
  BitReader in(bytes);
  EXPECT_EQ(in.bits(16), 0xFFFFu);
  EXPECT_EQ(in.bits(0), 0u);  // needs nothing
  EXPECT_TRUE(in.good());
  EXPECT_EQ(in.bits(1), 0u);
  EXPECT_EQ(in.fault(), "expected 1 more bits, but 0 are left");
  in.fail("a later one");
  in.fail_within("b");
  in.fail_within("[2]");
  in.fail_within("a");
  EXPECT_EQ(in.fault(), "a[2].b: expected 1 more bits, but 0 are left");
}

TEST(BitStream, LengthsChangeTheirFormAtTheirLimits) {
  struct Case {
    std::size_t size;
    base::Bytes first;
  };
  for (const Case& c : std::vector<Case>{{0, {0x00}},
                                         {1, {0x01}},
                                         {127, {0x7F}},          // the last of 8 bits
                                         {128, {0x80, 0x80}},    // the first of 16
                                         {16383, {0xBF, 0xFF}},  // the last of 16
                                         {16384, {0xC1}},        // one fragment and no rest
                                         {16385, {0xC1}},        // one fragment and one octet
                                         {65536, {0xC4}}}) {     // the largest fragment
    base::Bytes bytes;
    BitWriter(bytes).put_octets(octets(c.size));
    ASSERT_GE(bytes.size(), c.first.size());
    EXPECT_TRUE(std::equal(c.first.begin(), c.first.end(), bytes.begin())) << c.size;
    BitReader in(bytes);
    EXPECT_EQ(in.octets(), octets(c.size)) << c.size;
    EXPECT_TRUE(in.good()) << in.fault();
    EXPECT_EQ(in.left(), 0u) << c.size;
  }
}

TEST(BitStream, RejectsLengthsBeyondTheInput) {
  for (const base::Bytes& bytes : std::vector<base::Bytes>{{0x05, 1, 2, 3, 4},  // one octet short
                                                           {0xBF, 0xFF, 1},     // 16383 octets, 1 present
                                                           {0xC1, 1, 2},        // a truncated fragment
                                                           {0xC0, 0, 0},        // an empty fragment
                                                           {0xC5, 0, 0},        // above the largest fragment
                                                           {0x80},              // half a length
                                                           {}}) {
    BitReader in(bytes);
    EXPECT_LE(in.octets().size(), bytes.size());
    EXPECT_FALSE(in.good());
  }
}

TEST(BitStream, SmallNumbers) {
  base::Bytes bytes;
  BitWriter out(bytes);
  out.put_small_number(63);
  out.put(1, 1);  // starts a larger number
  BitReader in(bytes);
  EXPECT_EQ(in.small_number(), 63);
  EXPECT_TRUE(in.good());
  in.small_number();
  EXPECT_FALSE(in.good());
}

}  // namespace sf::v2x
