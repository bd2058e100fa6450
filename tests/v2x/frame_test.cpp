#include "v2x/frame.h"

#include <gtest/gtest.h>

#include "tests/v2x/random_frame.h"
#include "v2x/text_forms.h"

namespace sf::v2x {

namespace {

base::Bytes encoded(const Frame& frame) {
  base::Bytes bytes;
  encode(frame, bytes);
  return bytes;
}

Frame small_spat() {
  Frame frame;
  Spat& spat = std::get<Spat>(frame.message);
  spat.intersections.resize(1);
  spat.intersections[0].states.resize(1);
  spat.intersections[0].states[0].events.resize(1);
  return frame;
}

Frame small_map() {
  Frame frame;
  IntersectionGeometry& crossing = frame.message.emplace<MapData>().intersections.emplace_back();
  crossing.lanes.resize(1);
  crossing.lanes[0].nodes.nodes.resize(2);
  return frame;
}

std::string error_of(const std::string& hex) {
  Frame frame;
  return decode(*read_hex(hex), frame).error;
}

std::string start_of(const base::Bytes& bytes) { return hex_text(bytes).substr(0, 2000); }

void expect_round_trip(const Frame& frame) {
  const base::Bytes bytes = encoded(frame);
  Frame again;
  const DecodeResult result = decode(bytes, again);
  ASSERT_TRUE(result.ok()) << result.error << " in " << start_of(bytes);
  EXPECT_EQ(result.size, bytes.size());
  EXPECT_TRUE(frame == again) << start_of(bytes);
}

}  // namespace

TEST(Frame, AnyMessageWithinItsBoundsRoundTrips) {
  RandomFrame plain(11, false), extended(12, true);
  for (int i = 0; i < 400; ++i) expect_round_trip(plain());
  for (int i = 0; i < 400; ++i) expect_round_trip(extended());
}

TEST(Frame, TheSmallestMessagesRoundTrip) {
  expect_round_trip(small_spat());
  expect_round_trip(small_map());
  Frame frame;
  frame.message = MapData{};  // every list of MAP is optional
  expect_round_trip(frame);
}

TEST(Frame, TheLongestListsRoundTrip) {
  Frame spat = small_spat();
  IntersectionState& state = std::get<Spat>(spat.message).intersections[0];
  state.states.assign(255, state.states[0]);
  state.states[254].events.assign(16, state.states[0].events[0]);
  state.enabled_lanes.assign(16, 255);
  expect_round_trip(spat);
  std::get<Spat>(spat.message).intersections.assign(32, state);  // 16 KiB: its length is fragmented
  EXPECT_GT(encoded(spat).size(), 16'384u);
  expect_round_trip(spat);

  Frame map = small_map();
  IntersectionGeometry& crossing = std::get<MapData>(map.message).intersections[0];
  crossing.lanes.assign(255, crossing.lanes[0]);
  crossing.lanes[254].nodes.nodes.resize(63);
  expect_round_trip(map);
}

TEST(Frame, NamesKeepTheirLastCharacter) {
  Frame frame = small_spat();
  std::get<Spat>(frame.message).name = std::string(62, 'x') + '\x7F';
  std::get<Spat>(frame.message).intersections[0].name = std::string(1, '\0');
  expect_round_trip(frame);
}

TEST(Frame, OctetsAfterTheFrameAreCounted) {
  base::Bytes bytes = encoded(small_spat());
  const std::size_t size = bytes.size();
  bytes.insert(bytes.end(), {0, 0x13, 1});
  Frame frame;
  const DecodeResult result = decode(bytes, frame);
  ASSERT_TRUE(result.ok()) << result.error;
  EXPECT_EQ(result.size, size);
  frame.padding = {0, 0x13, 1};
  EXPECT_EQ(encoded(frame), bytes);
}

TEST(Frame, OctetsOfTheValueAfterTheMessageAreKept) {
  Frame frame = small_spat();
  frame.rest = {0xAA, 0x55};
  expect_round_trip(frame);
}

TEST(Frame, RejectsEveryTruncation) {
  RandomFrame make(5, true);
  for (int i = 0; i < 30; ++i) {
    const base::Bytes bytes = encoded(make());
    for (std::size_t size = 0; size < bytes.size(); size += 1 + size / 40) {
      Frame frame;
      EXPECT_FALSE(decode(std::span(bytes).first(size), frame).ok()) << size << " of " << start_of(bytes);
    }
  }
}

TEST(Frame, AFlippedBitIsReadOrRejected) {
  // A decoded frame can be encoded, and decodes to itself.
  RandomFrame make(6, true);
  for (int i = 0; i < 20; ++i) {
    const base::Bytes bytes = encoded(make());
    for (std::size_t bit = 0; bit < bytes.size() * 8; bit += 1 + bit / 100) {
      base::Bytes other = bytes;
      other[bit / 8] = static_cast<std::uint8_t>(other[bit / 8] ^ 0x80 >> bit % 8);
      Frame frame;
      if (decode(other, frame).ok()) expect_round_trip(frame);
    }
  }
}

TEST(Frame, ErrorsNameThePlaceAndTheReason) {
  EXPECT_EQ(error_of(""), "expected 1 more bits, but 0 are left");
  EXPECT_EQ(error_of("00140100"), "messageId: 20 (BasicSafetyMessage) is neither SPaT (19) nor MAP (18)");
  EXPECT_EQ(error_of("7FFF00"), "messageId: 32767 is neither SPaT (19) nor MAP (18)");
  EXPECT_EQ(
      error_of("0381004003"),
      "messageId: 897 (a message of IEEE 1609.2; expected the frame within it) is neither SPaT (19) nor MAP (18)");
  EXPECT_EQ(error_of("001300"), "SPAT: expected 1 more bits, but 0 are left");
  EXPECT_EQ(error_of("001305000000"), "expected 5 octets, but 3 are left");
}

TEST(Frame, NumbersAboveTheirBoundsAreRejected) {
  // Fields with more bits than their bound needs: a larger value is the sender's fault.
  Frame minute = small_spat();
  std::get<Spat>(minute.message).minute = 527'040;
  base::Bytes bytes = encoded(minute);
  // 24 bits of frame head, extension bit, three presence bits, then 20 bits of the minute.
  EXPECT_EQ(bytes[3], 0x48);
  bytes[3] = 0x4F;
  Frame frame;
  EXPECT_EQ(decode(bytes, frame).error, "SPAT.timeStamp: 985792 is above 527040");
}

TEST(Frame, EncodingAValueOutOfBoundsAborts) {
  Frame late = small_spat();
  std::get<Spat>(late.message).minute = 527'041;
  base::Bytes bytes;
  EXPECT_DEATH(encode(late, bytes), "527041 is not in \\[0, 527040\\]");
  EXPECT_DEATH(encode(Frame{}, bytes), "0 is not in \\[1, 32\\]");  // a SPaT without intersections
}

}  // namespace sf::v2x
