// Poses, angles, byte readers and writers.

#include "base/pose.h"

#include <gtest/gtest.h>

#include "base/bytes.h"
#include "base/error.h"
#include "base/hash.h"

namespace sf::base {
namespace {

TEST(Pose, ComposeRotatesThenTranslates) {
  const Pose X_AB{1, 2, 3, M_PI / 2};
  const Pose X_BC{10, 0, 0.5, -M_PI};
  const Pose X_AC = compose(X_AB, X_BC);
  EXPECT_NEAR(X_AC.x, 1.0, 1e-15);
  EXPECT_NEAR(X_AC.y, 12.0, 1e-14);
  EXPECT_EQ(X_AC.z, 3.5);
  EXPECT_EQ(X_AC.yaw, -M_PI / 2);
}

TEST(Pose, ComposeTransformsTheOrigin) {
  const Pose X_AB{-3, 0.5, 0, 0.7};
  const Pose X_BC{0.2, -0.9, 0, 1.1};
  const glm::dvec2 p_C{2, -5};
  const glm::dvec2 once = transform(compose(X_AB, X_BC), p_C);
  const glm::dvec2 twice = transform(X_AB, transform(X_BC, p_C));
  EXPECT_NEAR(once.x, twice.x, 1e-14);
  EXPECT_NEAR(once.y, twice.y, 1e-14);
}

TEST(Pose, InverseUndoesTheTransformation) {
  const Pose X_AB{-3, 0.5, 2, 0.7};
  const glm::dvec2 p_B{2, -5};
  const glm::dvec2 back = transform(inverse(X_AB), transform(X_AB, p_B));
  EXPECT_NEAR(back.x, p_B.x, 1e-14);
  EXPECT_NEAR(back.y, p_B.y, 1e-14);
  EXPECT_EQ(compose(inverse(X_AB), X_AB).z, 0.0);
  EXPECT_EQ(compose(inverse(X_AB), X_AB).yaw, 0.0);
}

TEST(Pose, HeadingsWrapToPlusMinusPi) {
  EXPECT_EQ(wrap_angle(0.0), 0.0);
  EXPECT_NEAR(wrap_angle(2.0 * M_PI + 0.25), 0.25, 1e-15);
  EXPECT_NEAR(wrap_angle(-2.0 * M_PI - 0.25), -0.25, 1e-15);
  EXPECT_NEAR(std::fabs(wrap_angle(3.0 * M_PI)), M_PI, 1e-15);
  EXPECT_LE(std::fabs(wrap_angle(1e9)), M_PI);
}

TEST(Bytes, RoundTrip) {
  Bytes bytes;
  ByteWriter writer(bytes);
  writer.put(std::uint16_t{0x1234});
  writer.put(-2.5);
  writer.put_string("scan");
  EXPECT_EQ(bytes[0], 0x34) << "little endian";
  EXPECT_EQ(writer.size(), 2u + 8u + 4u + 4u);
  ByteReader reader(bytes);
  EXPECT_EQ(reader.get<std::uint16_t>(), 0x1234);
  EXPECT_EQ(reader.get<double>(), -2.5);
  EXPECT_EQ(reader.get_string(), "scan");
  EXPECT_TRUE(reader.good());
  EXPECT_EQ(reader.left(), 0u);
}

/// A read past the end returns zeros and marks the reader as bad.
TEST(Bytes, StaysBadAfterReadingPastTheEnd) {
  const Bytes bytes{1, 2, 3};
  ByteReader reader(bytes);
  EXPECT_EQ(reader.get<std::uint32_t>(), 0u);
  EXPECT_FALSE(reader.good());
  EXPECT_EQ(reader.get<std::uint8_t>(), 0u) << "though a byte is left";
  EXPECT_EQ(ByteReader(bytes).get_bytes(4).size(), 0u);
  const Bytes liar{0xFF, 0xFF, 0xFF, 0xFF, 'x'};
  ByteReader text(liar);
  EXPECT_EQ(text.get_string(), "") << "a length of 4 GiB in five bytes";
  EXPECT_FALSE(text.good());
}

TEST(Hash, ChainsAndPrints) {
  const char text[] = "abcdef";
  EXPECT_EQ(hash_bytes(text, 6), hash_bytes(text, 6));
  EXPECT_NE(hash_bytes(text, 6), hash_bytes(text, 5));
  EXPECT_NE(hash_bytes(text + 3, 3, hash_bytes(text, 3)), hash_bytes(text, 3, hash_bytes(text + 3, 3))) << "order";
  EXPECT_EQ(hash_hex(0x1F), "000000000000001f");
}

TEST(Error, ContainsFileLineAndMessage) {
  EXPECT_STREQ(InputError("w.world", 12, "expected a number").what(), "w.world:12: expected a number");
  EXPECT_STREQ(InputError("w.world", 0, "cannot be read").what(), "w.world: cannot be read");
}

TEST(ErrorDeathTest, FailedCheckAbortsWithValues) {
  EXPECT_DEATH(SF_CHECK(1 > 2, "1 is not above 2"), "1 is not above 2");
}

}  // namespace
}  // namespace sf::base
