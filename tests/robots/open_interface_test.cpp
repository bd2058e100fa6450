#include "robots/open_interface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "tests/units.h"

namespace sf::robots {
namespace {

TEST(OpenInterface, SaturatesWheelsAlongTheArc) {
  struct Case {
    base::Twist twist;
    int right, left;
    const char* why;
  };
  for (const Case& c : std::vector<Case>{{{0.1, 0, 0}, 100, 100, "straight"},
                                         {{0, 0, 1}, 129, -129, "in place: half a track each"},
                                         {{0.5, 0, 0}, 500, 500, "at the limit"},
                                         {{-0.7, 0, 0}, -500, -500, "beyond it, backwards"},
                                         {{0.5, 0, 1}, 500, 295, "the slower wheel slows down alike"},
                                         {{0.2, 0.3, 0}, 200, 200, "it cannot drive sideways"},
                                         {{kNaN, 0, 1}, 0, 0, "not a number"},
                                         {{0.1, 0, kInf}, 0, 0, "infinite"},
                                         {{1e308, 0, 1e308}, 0, 0, "the wheels' speed overflows"}}) {
    const CreateWheels wheels = create_wheels(c.twist, 0.258);
    EXPECT_EQ(wheels.right, c.right) << c.why;
    EXPECT_EQ(wheels.left, c.left) << c.why;
  }
}

TEST(OpenInterface, EncodesCommandsAsSpecified) {
  EXPECT_EQ(create_drive({-200, 500}), (base::Bytes{145, 0xFF, 0x38, 0x01, 0xF4}));
  EXPECT_EQ(create_start(), (base::Bytes{128, 131, 145, 0,  0,  0,  0,  148, 21, 7,  8,  9,  10, 11, 12,
                                         13,  14,  17,  18, 19, 20, 21, 22,  23, 24, 25, 26, 32, 33, 35}));
  EXPECT_EQ(create_outputs(0b11101010), (base::Bytes{147, 0b010, 138, 0b101}));
  EXPECT_EQ(create_stop(), (base::Bytes{145, 0, 0, 0, 0, 150, 0, 128}));
}

/// Bumped right, no floor at the front right, 12 mm backwards, 3 degrees to the right, 16.1 V, -0.3 A, -1 degree
/// Celsius, 40000 mAh, inputs 0 and 2 high, 1022 of 1023 at the analogue one, safe.
const base::Bytes kFrame = [] {
  base::Bytes bytes{19,   49,   7,   1,    8,  0,    9,    0,    10,   0,    11,   1,  12, 0,    13,   0,    14,
                    8,    17,   248, 18,   1,  19,   0xFF, 0xF4, 20,   0xFF, 0xFD, 21, 3,  22,   0x3E, 0xE4, 23,
                    0xFE, 0xD4, 24,  0xFF, 25, 0x9C, 0x40, 26,   0x0A, 0x8C, 32,   5,  33, 0x03, 0xFE, 35,   2};
  bytes.push_back(static_cast<std::uint8_t>(-std::accumulate(bytes.begin(), bytes.end(), 0)));
  return bytes;
}();

std::vector<CreateFrame> taken(CreateStream& stream, std::initializer_list<base::Bytes> all) {
  std::vector<CreateFrame> frames;
  for (const base::Bytes& bytes : all)
    for (const std::uint8_t byte : bytes)
      if (const auto frame = stream.take(byte)) frames.push_back(*frame);
  return frames;
}

TEST(CreateStream, ReadsTheWheelsOfACreate2) {
  base::Bytes bytes = kFrame;
  bytes[22] = 43;
  bytes[25] = 44;
  bytes.back() = static_cast<std::uint8_t>(bytes.back() - (43 - 19) - (44 - 20));
  CreateStream stream(CreateOdometry::wheels);
  const std::vector<CreateFrame> frames = taken(stream, {kFrame, bytes});
  ASSERT_EQ(frames.size(), 1u) << "frames of motion are not those that were requested";
  EXPECT_EQ(frames[0].left, 0xFFF4);
  EXPECT_EQ(frames[0].right, 0xFFFD);
  EXPECT_EQ(create_start(CreateOdometry::wheels)[19], 43);
  EXPECT_EQ(create_start(CreateOdometry::wheels)[20], 44);
}

TEST(CreateStream, ReadsAFrame) {
  CreateStream stream;
  const std::vector<CreateFrame> frames = taken(stream, {kFrame});
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_TRUE(frames[0].bumped_right);
  EXPECT_FALSE(frames[0].bumped_left);
  EXPECT_EQ(frames[0].cliffs, (std::array<std::uint8_t, 4>{0, 0, 1, 0}));
  EXPECT_EQ(frames[0].overcurrents, 8);
  EXPECT_EQ(frames[0].infrared, 248);
  EXPECT_EQ(frames[0].buttons, 1);
  EXPECT_EQ(frames[0].charging, 3);
  EXPECT_EQ(frames[0].voltage, 16'100);
  EXPECT_EQ(frames[0].current, -300);
  EXPECT_EQ(frames[0].temperature, -1);
  EXPECT_EQ(frames[0].charge, 40'000) << "unsigned";
  EXPECT_EQ(frames[0].capacity, 2700);
  EXPECT_EQ(frames[0].inputs, 5);
  EXPECT_EQ(frames[0].analog, 1022);
  EXPECT_FALSE(frames[0].wheel_drop);
  EXPECT_EQ(frames[0].distance, -12);
  EXPECT_EQ(frames[0].angle, -3);
  EXPECT_EQ(frames[0].mode, CreateFrame::safe);
  EXPECT_EQ(stream.skipped(), 0u);
}

base::Bytes with(std::size_t at, std::uint8_t byte) {
  base::Bytes bytes = kFrame;
  bytes[at] = byte;
  return bytes;
}
base::Bytes without(std::size_t at) {
  base::Bytes bytes = kFrame;
  bytes.erase(bytes.begin() + at);
  return bytes;
}

TEST(CreateStream, RecoversAfterDamage) {
  struct Case {
    base::Bytes damage;
    std::uint64_t wrong_checksums;
    const char* why;
  };
  std::vector<Case> cases{
      {{'b', 'l', ' ', 'v', '1', '\n'}, 0, "text of its start"},
      {{19}, 0, "a header alone"},
      {{19, 19, 44, 19, 44, 7}, 0, "headers one upon another"},
      {with(kFrame.size() - 1, static_cast<std::uint8_t>(kFrame.back() + 1)), 1, "a wrong checksum"},
      {with(5, 0x7F), 1, "a wrong number"},
      {with(8, 29), 0, "an unrequested packet"},
      {with(1, 200), 0, "an invalid length"}};
  for (std::size_t at = 0; at < kFrame.size(); ++at) cases.push_back({without(at), 0, "a lost byte"});
  for (const Case& c : cases) {
    CreateStream stream;
    // The byte after a frame that lost a byte may complete it by length alone.
    const std::size_t frames = taken(stream, {kFrame, c.damage, kFrame, kFrame}).size();
    EXPECT_EQ(frames, 3u) << c.why;
    EXPECT_EQ(stream.frames(), frames);
    EXPECT_EQ(stream.skipped(), c.damage.size()) << c.why;
    EXPECT_GE(stream.wrong_checksums(), c.wrong_checksums) << c.why;
  }
}

/// The last byte is lost: the next frame's header takes the place of the checksum, but that frame must not be lost.
TEST(CreateStream, FindsTheFrameThatBeginsInABrokenOne) {
  CreateStream stream;
  EXPECT_EQ(taken(stream, {without(kFrame.size() - 1), kFrame}).size(), 1u);
  EXPECT_EQ(stream.wrong_checksums(), 1u);
}

TEST(CreateStream, AcceptsAnyBytes) {
  CreateStream stream;
  std::mt19937 random(7);
  std::uint64_t bytes = 0;
  for (; bytes < 100'000; ++bytes) stream.take(static_cast<std::uint8_t>(random() % 4 == 0 ? 19 : random()));
  EXPECT_LE(stream.skipped() + CreateStream::kFrameBytes * stream.frames(), bytes);
  EXPECT_EQ(taken(stream, {kFrame, kFrame}).back().distance, -12);
}

}  // namespace
}  // namespace sf::robots
