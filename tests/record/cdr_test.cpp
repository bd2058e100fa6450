#include "record/cdr.h"

#include <gtest/gtest.h>

#include <limits>

namespace sf::record {
namespace {

using base::Bytes;

TEST(Cdr, StartsWithTheLittleEndianEncapsulation) {
  Bytes out;
  const CdrWriter cdr(out);
  EXPECT_EQ(out, (Bytes{0, 1, 0, 0}));
}

TEST(Cdr, AlignsEachNumberToItsSize) {
  Bytes out;
  CdrWriter cdr(out);
  cdr.put(true);
  cdr.put(std::uint16_t{0x0201});                   // 1 byte of padding, then at 2
  cdr.put(std::uint8_t{9});                         // at 4
  cdr.put(std::uint32_t{0x04030201});               // 3 bytes of padding, then at 8
  cdr.put(std::uint8_t{9});                         // at 12
  cdr.put(1.0);                                     // 3 bytes of padding, then at 16
  EXPECT_EQ(out, (Bytes{0, 1, 0, 0,                 // encapsulation
                        1, 0, 1, 2, 9, 0, 0,    0,  //
                        1, 2, 3, 4, 9, 0, 0,    0,  //
                        0, 0, 0, 0, 0, 0, 0xF0, 0x3F}));
}

TEST(Cdr, AlignmentCountsFromTheEndOfTheEncapsulation) {
  Bytes out = {77};
  CdrWriter cdr(out);
  cdr.put(std::uint8_t{9});
  cdr.put(std::uint32_t{5});
  EXPECT_EQ(out, (Bytes{77, 0, 1, 0, 0, 9, 0, 0, 0, 5, 0, 0, 0}));
}

TEST(Cdr, NoPaddingBeforeAlignedNumbers) {
  Bytes out;
  CdrWriter cdr(out);
  cdr.put(1.0);
  cdr.put(std::uint32_t{1});
  cdr.put(2.0F);
  cdr.put(1.0);
  EXPECT_EQ(out.size(), 4u + 8u + 4u + 4u + 8u);
}

TEST(Cdr, StringLengthsIncludeTheTerminator) {
  Bytes out;
  CdrWriter cdr(out);
  cdr.put("ab");
  cdr.put("");
  EXPECT_EQ(out, (Bytes{0, 1, 0, 0, 3, 0, 0, 0, 'a', 'b', 0, 0, 1, 0, 0, 0, 0}));
}

TEST(Cdr, RoundTrips) {
  Bytes out;
  CdrWriter cdr(out);
  cdr.put(true);
  cdr.put(std::numeric_limits<double>::denorm_min());
  cdr.put("name");
  cdr.put(std::int32_t{-5});
  cdr.put_count(2);
  cdr.put(0.5F);
  cdr.put(std::numeric_limits<float>::infinity());
  CdrReader in(out);
  EXPECT_TRUE(in.get<bool>());
  EXPECT_EQ(in.get<double>(), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(in.get_string(), "name");
  EXPECT_EQ(in.get<std::int32_t>(), -5);
  ASSERT_EQ(in.get_count(4), 2u);
  EXPECT_EQ(in.get<float>(), 0.5F);
  EXPECT_EQ(in.get<float>(), std::numeric_limits<float>::infinity());
  EXPECT_TRUE(in.good());
  in.get<std::uint8_t>();
  EXPECT_FALSE(in.good());  // one byte past the end
}

/// Malformed messages, one reason each.
TEST(Cdr, MalformedMessagesSetTheReaderToBad) {
  EXPECT_FALSE(CdrReader(Bytes{}).good());            // empty
  EXPECT_FALSE(CdrReader(Bytes{0, 1, 0}).good());     // truncated in the encapsulation
  EXPECT_FALSE(CdrReader(Bytes{0, 0, 0, 0}).good());  // big endian
  const auto string_is_good = [](const Bytes& bytes) {
    CdrReader in(bytes);
    EXPECT_EQ(in.get_string(), "");
    return in.good();
  };
  EXPECT_FALSE(string_is_good({0, 1, 0, 0, 0, 0, 0, 0}));                      // no room for the terminator
  EXPECT_FALSE(string_is_good({0, 1, 0, 0, 2, 0, 0, 0, 'a', 'b'}));            // not terminated
  EXPECT_FALSE(string_is_good({0, 1, 0, 0, 3, 0, 0, 0, 'a', 0}));              // longer than the message
  EXPECT_FALSE(string_is_good({0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 'a', 0}));  // absurdly long
  EXPECT_TRUE(string_is_good({0, 1, 0, 0, 1, 0, 0, 0, 0}));                    // empty, and valid
}

TEST(Cdr, RejectsCountsBeyondTheMessageBeforeAllocating) {
  const Bytes bytes = {0, 1, 0, 0, 3, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  EXPECT_EQ(CdrReader(bytes).get_count(4), 0u);  // 11 bytes cannot hold three numbers of four
  EXPECT_EQ(CdrReader(bytes).get_count(3), 3u);
  const Bytes absurd = {0, 1, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0, 0, 0};
  EXPECT_EQ(CdrReader(absurd).get_count(1), 0u);
}

TEST(Cdr, PaddingPastTheEndSetsTheReaderToBad) {
  const Bytes bytes = {0, 1, 0, 0, 1};
  CdrReader in(bytes);
  in.get<bool>();
  EXPECT_TRUE(in.good());
  EXPECT_EQ(in.get<double>(), 0.0);
  EXPECT_FALSE(in.good());
}

}  // namespace
}  // namespace sf::record
