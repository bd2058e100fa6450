// The accuracy word of the header.

#include <gtest/gtest.h>

#include <cmath>

#include "netio/packets.h"

namespace sf::netio {
namespace {

TEST(AccuracyWord, NothingStatedIsZero) {
  EXPECT_EQ(encode_accuracy({}), 0u);
  EXPECT_EQ(encode_accuracy({0, false, HUGE_VAL}), 0u);
  EXPECT_TRUE(std::isinf(decode_accuracy(0).bound));
}

TEST(AccuracyWord, ModesAndFlagsRoundTrip) {
  for (std::uint8_t mode = 0; mode < 16; ++mode)
    for (const bool unsure : {false, true}) {
      const Accuracy back = decode_accuracy(encode_accuracy({mode, unsure, 1e-9}));
      EXPECT_EQ(back.mode, mode);
      EXPECT_EQ(back.unsure, unsure);
    }
}

/// Encoding may enlarge a bound by a sixteenth of an octave, and never reduces it.
TEST(AccuracyWord, BoundsAreRoundedUp) {
  for (double bound = 1e-18; bound < 1e18; bound *= 1.0137) {
    const double back = decode_accuracy(encode_accuracy({0, false, bound})).bound;
    ASSERT_GE(back, bound);
    ASSERT_LE(back, 1.0443 * bound);
  }
  EXPECT_EQ(decode_accuracy(encode_accuracy({0, false, 1.0})).bound, std::exp2(1.0 / 16.0)) << "always above the bound";
}

TEST(AccuracyWord, Saturates) {
  EXPECT_EQ(decode_accuracy(encode_accuracy({0, false, 0.999 * std::exp2(1023.0 / 16.0)})).bound,
            std::exp2(1023.0 / 16.0))
      << "the largest";
  EXPECT_EQ(decode_accuracy(encode_accuracy({0, true, std::exp2(1023.0 / 16.0)})).bound, HUGE_VAL) << "never less";
  EXPECT_EQ(encode_accuracy({3, true, 1e300}), 0x13u) << "no bound; mode and flag stay";
  EXPECT_EQ(decode_accuracy(encode_accuracy({0, false, 1e-300})).bound, std::exp2(-1023.0 / 16.0));
  EXPECT_EQ(decode_accuracy(encode_accuracy({0, false, -1.0})).bound, HUGE_VAL) << "no bound";
}

}  // namespace
}  // namespace sf::netio
