// Magnetometer readings as bytes.

#include "sensors/magnetometer_packets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "sensors/magnetometer.h"
#include "tests/sensors/chance.h"

namespace sf::sensors {
namespace {

SensorSpec row(std::uint32_t elements, double limit = 0.0) {
  SensorSpec r;
  r.elements = elements;
  r.limit = limit;
  return r;
}

base::Bytes bytes_of(std::vector<double> values, WireFormat wire, std::uint8_t expected = kMagnetometer) {
  base::ReadingBlock reading;
  reading.values = values;
  base::Bytes out;
  EXPECT_EQ(encode_magnetometer(row(static_cast<std::uint32_t>(values.size() / 4)), reading, wire, 0, out), expected);
  return out;
}

TEST(MagnetometerPackets, EncodesEveryByteOfTheFarmForm) {
  // 1 Gauss, -1e-4 Gauss, 0x01020304 units and 0.
  const base::Bytes bytes = bytes_of({1e-4, -1e-8, 0x01020304 * 1e-8, 0.0}, WireFormat::farm);
  EXPECT_EQ(bytes, (base::Bytes{1, 0, 0, 0, 0x10, 0x27, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 4, 3, 2, 1, 0, 0, 0, 0}));
}

TEST(MagnetometerPackets, EncodesEveryByteOfTheThesisForm) {
  const base::Bytes bytes = bytes_of({1e-4, 7, 7, 7, -2e-8, 7, 7, 7}, WireFormat::thesis);
  EXPECT_EQ(bytes, (base::Bytes{0x10, 0x27, 0, 0, 0xFE, 0xFF, 0xFF, 0xFF}));
}

TEST(MagnetometerPackets, RoundsToNearestAndSaturates) {
  const auto word = [](double tesla) {
    std::int32_t units = 0;
    std::memcpy(&units, bytes_of({tesla, 0, 0, 0}, WireFormat::farm).data() + 4, sizeof units);
    return 1e-8 * units;
  };
  EXPECT_DOUBLE_EQ(word(1.49e-8), 1e-8);
  EXPECT_DOUBLE_EQ(word(1.51e-8), 2e-8);
  EXPECT_DOUBLE_EQ(word(-1.51e-8), -2e-8);
  EXPECT_EQ(word(0.49e-8), 0.0);
  EXPECT_DOUBLE_EQ(word(21.47483647), 21.47483647) << "214748.3647 Gauss, the thesis' most";
  EXPECT_DOUBLE_EQ(word(21.48), 21.47483647);
  EXPECT_DOUBLE_EQ(word(1e300), 21.47483647);
  EXPECT_DOUBLE_EQ(word(std::numeric_limits<double>::infinity()), 21.47483647);
  EXPECT_DOUBLE_EQ(word(-1e300), -21.47483648);
}

TEST(MagnetometerPackets, DoesNotSendNan) {
  for (std::size_t i = 0; i < 8; ++i) {
    std::vector<double> values(8, 1e-5);
    values[i] = std::nan("");
    EXPECT_TRUE(bytes_of(values, WireFormat::farm, 0).empty());
    EXPECT_TRUE(bytes_of(values, WireFormat::thesis, 0).empty());
  }
}

TEST(MagnetometerPackets, RejectsImpossibleValues) {
  const base::Bytes good = bytes_of({1e-5, 0, 0, 1e-5, 2e-5, 0, 0, 2e-5}, WireFormat::farm);
  const auto fault = [&](base::Bytes bytes, SensorSpec sensor, WireFormat wire = WireFormat::farm,
                         std::uint8_t type = 3) { return decode_magnetometer(sensor, bytes, type, wire).fault; };
  EXPECT_EQ(fault(good, row(2)), PayloadError::none);
  EXPECT_EQ(fault(good, row(0)), PayloadError::none) << "of any number of elements";
  EXPECT_EQ(decode_magnetometer(row(0), good, kMagnetometer, WireFormat::farm).elements, 2u);
  EXPECT_EQ(fault(good, row(3)), PayloadError::out_of_range) << "of another array";
  EXPECT_EQ(fault(good, row(2, 2e-5)), PayloadError::none) << "at the limit";
  EXPECT_EQ(fault(good, row(2, 1.9e-5)), PayloadError::out_of_range) << "beyond what the sensor can read";
  EXPECT_EQ(fault(good, row(2), WireFormat::farm, 3 + kExtended), PayloadError::out_of_range)
      << "there is no second form";
  EXPECT_EQ(fault(good, row(2), WireFormat::farm, 1), PayloadError::out_of_range) << "a laser's";
  EXPECT_EQ(fault({}, row(2)), PayloadError::too_short);
  EXPECT_EQ(fault({1, 0, 0}, row(2)), PayloadError::too_short);
  EXPECT_EQ(fault({0, 0, 0, 0}, row(0)), PayloadError::out_of_range) << "of no elements";
  EXPECT_EQ(fault({}, row(0), WireFormat::thesis), PayloadError::too_short);
  EXPECT_EQ(fault({1, 2, 3}, row(0), WireFormat::thesis), PayloadError::too_short);
  EXPECT_EQ(fault({1, 2, 3, 4, 5}, row(0), WireFormat::thesis), PayloadError::too_long);
  EXPECT_EQ(fault(base::Bytes(64, 0), row(0), WireFormat::thesis), PayloadError::none);
  EXPECT_EQ(fault(base::Bytes(68, 0), row(0), WireFormat::thesis), PayloadError::out_of_range) << "seventeen elements";
  for (std::size_t size = 0; size < good.size(); ++size)
    EXPECT_EQ(fault({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}, row(2)), PayloadError::too_short)
        << size;
  base::Bytes longer = good;
  longer.push_back(0);
  EXPECT_EQ(fault(longer, row(2)), PayloadError::too_long);
}

/// A saturated word represents any larger value.
TEST(MagnetometerPackets, AcceptsASaturatedWord) {
  const base::Bytes bytes = bytes_of({100.0, -100.0, 0, 0}, WireFormat::farm);
  EXPECT_EQ(decode_magnetometer(row(1, 50.0), bytes, kMagnetometer, WireFormat::farm).fault, PayloadError::none);
}

/// Arbitrary bytes are validated without a crash.
TEST(MagnetometerPackets, ValidatesAnyBytes) {
  trial::Chance chance(2);
  for (int i = 0; i < 5000; ++i) {
    base::Bytes bytes(chance.below(300));
    for (std::uint8_t& b : bytes) b = static_cast<std::uint8_t>(chance.below(256));
    if (bytes.size() > 1 && i % 2 == 0) bytes[0] = static_cast<std::uint8_t>((bytes.size() - 4) / 16), bytes[1] = 0;
    for (const WireFormat wire : {WireFormat::farm, WireFormat::thesis}) {
      const PayloadPart part = decode_magnetometer(row(chance.below(4)), bytes, kMagnetometer, wire);
      if (part.fault == PayloadError::none) {
        EXPECT_GE(part.elements, 1u);
        EXPECT_LE(part.elements, kMostElements);
      }
    }
  }
}

}  // namespace
}  // namespace sf::sensors
