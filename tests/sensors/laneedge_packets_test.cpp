// Lane edge readings as bytes.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sensors/laneedge.h"
#include "sensors/laneedge_packets.h"
#include "tests/units.h"

namespace sf::sensors {
namespace {

base::Bytes encoded(const std::vector<double>& values, WireFormat wire) {
  base::ReadingBlock block;
  block.values = values;
  base::Bytes out;
  EXPECT_EQ(encode_lane_edge({}, block, wire, 0, out), kLaneEdge);
  return out;
}

TEST(LaneEdgePackets, EncodesEveryByte) {
  const base::Bytes farm = encoded({0.25, 61, 0.000'123, 0.004'567}, WireFormat::farm);
  EXPECT_EQ(farm, (base::Bytes{0xFA, 0x00, 61, 0, 123, 0, 0, 0, 0xD7, 0x11, 0, 0}));
  EXPECT_EQ(encoded({0.25, 61, 0.1, 0.1}, WireFormat::thesis), (base::Bytes{0xFA, 0x00}));
}

std::uint16_t millimetres(double metres) {
  const base::Bytes b = encoded({metres, 2, 0, 0}, WireFormat::thesis);
  return static_cast<std::uint16_t>(b[0] | b[1] << 8);
}

TEST(LaneEdgePackets, RoundsToNearestAndSaturates) {
  EXPECT_EQ(millimetres(0.0), 0);
  EXPECT_EQ(millimetres(0.0004), 0);
  EXPECT_EQ(millimetres(0.0006), 1);
  EXPECT_EQ(millimetres(1.2344), 1234);
  EXPECT_EQ(millimetres(65.534), 65'534);
  EXPECT_EQ(millimetres(65.6), 65'534) << "a far edge is still in sight";
  EXPECT_EQ(millimetres(std::numeric_limits<double>::infinity()), 65'534);
  EXPECT_EQ(millimetres(std::numeric_limits<double>::quiet_NaN()), 65'535);
  EXPECT_EQ(millimetres(-1.0), 0);
}

TEST(LaneEdgePackets, NoEdgeInSightKeepsItsPoints) {
  EXPECT_EQ(encoded({kNaN, 1, 0, kNaN}, WireFormat::farm),
            (base::Bytes{0xFF, 0xFF, 1, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF}));
  EXPECT_EQ(encoded({0.1, 1e9, 1e9, 1e9}, WireFormat::farm),
            (base::Bytes{100, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF}));
}

TEST(LaneEdgePackets, AnyBytesDecodeToAPartOrAFault) {
  for (const WireFormat wire : {WireFormat::farm, WireFormat::thesis}) {
    const std::size_t right = wire == WireFormat::farm ? 12 : 2;
    for (std::size_t size = 0; size < 20; ++size) {
      const std::vector<std::uint8_t> bytes(size, 0xA5);
      const PayloadError expected = size < right   ? PayloadError::too_short
                                    : size > right ? PayloadError::too_long
                                                   : PayloadError::none;
      EXPECT_EQ(decode_lane_edge({}, bytes, kLaneEdge, wire).fault, expected) << size;
    }
  }
  EXPECT_EQ(decode_lane_edge({}, std::vector<std::uint8_t>(12), 7, WireFormat::farm).fault, PayloadError::out_of_range);
  EXPECT_EQ(decode_lane_edge({}, std::vector<std::uint8_t>(12), kLaneEdge, WireFormat::farm).elements, 1u);
}

TEST(LaneEdgePackets, UsesOneDatagramAndIsNeverRejected) {
  for (const WireFormat wire : {WireFormat::farm, WireFormat::thesis}) {
    EXPECT_EQ(lane_edge_parts({}, wire), 1u);
    EXPECT_EQ(lane_edge_wire_problem({}, wire), "");
  }
}

}  // namespace
}  // namespace sf::sensors
