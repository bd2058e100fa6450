// The code of ARToolKitPlus's markers.

#include "vision/bch_code.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "tests/instrumented.h"

namespace sf::vision {

namespace {

BchWord turned(BchWord cells, int turns) {
  for (int i = 0; i < turns; ++i) cells = turn_bch(cells);
  return cells;
}

/// Counts of decoded words with known ids.
struct Decoded {
  std::uint64_t right = 0, wrong = 0, refused = 0;
};

/// Decodes every id with every combination of `errors` wrong cells, 1 or 2.
Decoded decode_all(int errors, std::uint32_t step) {
  Decoded count;
  for (std::uint32_t id = 0; id < kBchIds; id += step)
    for (int i = 0; i < 36; ++i)
      for (int k = errors == 1 ? i : i + 1; k < (errors == 1 ? i + 1 : 36); ++k) {
        const int turns = (i + k) % 4;
        const auto match = decode_bch(turned(encode_bch(id) ^ (BchWord{1} << i | BchWord{1} << k), turns));
        if (!match)
          ++count.refused;
        else if (match->id == id && match->turns == turns && match->errors == errors)
          ++count.right;
        else
          ++count.wrong;
      }
  return count;
}

}  // namespace

/// Cells of images written by ARToolKitPlus's generator (IdPatGen -bch), with either border.
TEST(BchCode, WordsAreThoseOfArToolKitPlus) {
  for (const auto& [id, cells] : std::initializer_list<std::pair<std::uint32_t, BchWord>>{{0, 0x8F80B8750},
                                                                                          {1, 0x8F9D0A027},
                                                                                          {2, 0x8FA66EEC9},
                                                                                          {100, 0x89C72312F},
                                                                                          {1234, 0xC2AB63443},
                                                                                          {2047, 0xF07A2BC03},
                                                                                          {4095, 0x70759F1F6}}) {
    EXPECT_EQ(encode_bch(id), cells) << id;
    const auto match = decode_bch(cells);
    ASSERT_TRUE(match) << id;
    EXPECT_EQ(match->id, id);
    EXPECT_EQ(match->errors, 0);
    EXPECT_EQ(match->turns, 0);
  }
}

TEST(BchCode, TurnsClockwise) {
  constexpr BchWord kUpperLeft = BchWord{1} << 35, kUpperRight = BchWord{1} << 30;
  EXPECT_EQ(turn_bch(kUpperLeft), kUpperRight);
  EXPECT_EQ(turn_bch(kUpperRight), BchWord{1});
  EXPECT_EQ(turned(0x123456789, 4), BchWord{0x123456789});
}

TEST(BchCode, ReadsAllIdsInAllOrientations) {
  for (std::uint32_t id = 0; id < kBchIds; ++id)
    for (int turns = 0; turns < 4; ++turns) {
      const auto match = decode_bch(turned(encode_bch(id), turns));
      ASSERT_TRUE(match) << id << " turned " << turns;
      EXPECT_EQ(match->id, id);
      EXPECT_EQ(match->turns, turns);
    }
}

/// Upright, any word with up to four wrong cells is nearer to its id than to any other: the distance is 9.
TEST(BchCode, CorrectsUpToFourErrorsOfUprightWords) {
  std::mt19937_64 random(1);
  const std::uint32_t step = instrumented() ? 64 : 1;
  for (std::uint32_t id = 0; id < kBchIds; id += step)
    for (int i = 0; i < 36; ++i)
      for (int k = i; k < 36; ++k) {
        const BchWord two = BchWord{1} << i | BchWord{1} << k;
        for (const BchWord errors : {two, two | BchWord{1} << random() % 36 | BchWord{1} << random() % 36}) {
          const auto match = decode_upright_bch(encode_bch(id) ^ errors);
          ASSERT_TRUE(match) << id;
          ASSERT_EQ(match->id, id);
          ASSERT_EQ(match->errors, __builtin_popcountll(errors));
        }
      }
}

/// Two ids differ by two cells if one is turned: a single error halfway between them is refused. All other single
/// errors are corrected in any orientation.
TEST(BchCode, CorrectsSingleErrorsInAnyOrientation) {
  const Decoded count = decode_all(1, 1);
  EXPECT_EQ(count.wrong, 0u);
  EXPECT_EQ(count.refused, 4u);
  EXPECT_EQ(count.right, 4096u * 36 - 4);
}

/// Of 2 580 480 double errors, 510 lead halfway or farther to an id that differs by two to four cells if it is turned.
TEST(BchCode, CorrectsDoubleErrorsInAnyOrientation) {
  const Decoded count = decode_all(2, instrumented() ? 64 : 1);
  EXPECT_LE(count.wrong, 14u);
  EXPECT_LE(count.refused, 496u);
  EXPECT_GT(count.right, 40'000u);
}

TEST(BchCode, RefusesUniformCells) {
  EXPECT_FALSE(decode_bch(0));
  EXPECT_FALSE(decode_bch((BchWord{1} << 36) - 1));
}

/// 4096 ids with 1 + 36 + 630 + 7140 + 58905 words each, of 2^36: 0.398 % upright, and up to 1.59 % in any orientation.
TEST(BchCode, AcceptsRandomCellsAtTheExpectedRate) {
  std::mt19937_64 random(2);
  constexpr int kCount = 1'000'000;
  int upright = 0, any = 0;
  for (int i = 0; i < kCount; ++i) {
    const BchWord cells = random() >> 28;
    upright += decode_upright_bch(cells) ? 1 : 0;
    any += decode_bch(cells) ? 1 : 0;
  }
  constexpr double kRate = 66712.0 * 4096 / 68719476736.0;
  EXPECT_NEAR(upright, kCount * kRate, 4.0 * std::sqrt(kCount * kRate));
  EXPECT_LT(any, kCount * 4.0 * kRate);
  EXPECT_GT(any, kCount * 4.0 * kRate * 0.96) << "words that two orientations share are refused";
}

}  // namespace sf::vision
