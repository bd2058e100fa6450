// Decoded payloads equal the encoded values, to the wire's rounding.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sensors/laneedge.h"
#include "sensors/laser.h"
#include "sensors/magnetometer.h"
#include "sensors/sensor_type.h"
#include "tests/sensors/chance.h"
#include "tests/units.h"

namespace sf::sensors {
namespace {

SensorSpec row_of_elements(std::uint32_t elements, double limit = 0.0) {
  SensorSpec row;
  row.elements = elements;
  row.limit = limit;
  return row;
}

/// Returns a receiver's values after every part of `values`.
std::vector<double> back(std::uint8_t id, const SensorSpec& row, const std::vector<double>& values, WireFormat wire) {
  const SensorType& type = *find_sensor_type(id);
  base::ReadingBlock block;
  block.type = id;
  block.values = values;
  std::vector<double> read(values.size(), kNaN);
  for (std::uint32_t part = 0; part < type.parts(row, wire); ++part) {
    base::Bytes bytes;
    const std::uint8_t packet_type = type.encode(row, block, wire, part, bytes);
    EXPECT_NE(packet_type, 0);
    const PayloadPart judged = type.decode(row, bytes, packet_type, wire);
    EXPECT_EQ(judged.fault, PayloadError::none);
    EXPECT_EQ(judged.part, part);
    type.read(row, bytes, packet_type, wire, read);
  }
  return read;
}

TEST(ReadingBack, EveryTypeReads) {
  for (const SensorType* type : sensor_types()) EXPECT_NE(type->read, nullptr) << type->name;
}

TEST(ReadingBack, PlainScansToTheMillimetre) {
  trial::Chance chance(1);
  for (const WireFormat wire : {WireFormat::farm, WireFormat::thesis})
    for (const std::uint32_t samples : {1u, 2u, 360u, 361u}) {
      std::vector<double> ranges;
      for (std::uint32_t i = 0; i < samples; ++i) ranges.push_back(chance.between(0.0, 8.0));
      const std::vector<double> read = back(sensors::kLaser, row_of_elements(samples, 8.0), ranges, wire);
      for (std::uint32_t i = 0; i < samples; ++i) EXPECT_NEAR(read[i], ranges[i], 0.500001e-3);
    }
}

TEST(ReadingBack, ExtendedScansPartByPart) {
  trial::Chance chance(2);
  for (const std::uint32_t samples : {1u, 310u, 311u, 620u, 1000u}) {
    std::vector<double> ranges;
    for (std::uint32_t i = 0; i < samples; ++i) ranges.push_back(chance.between(0.0, 200.0));
    const std::vector<double> read = back(sensors::kLaser, row_of_elements(samples, 200.0), ranges, WireFormat::farm);
    for (std::uint32_t i = 0; i < samples; ++i) EXPECT_NEAR(read[i], ranges[i], 0.500001e-4) << i;
  }
}

TEST(ReadingBack, PartLeavesOtherPartsUnchanged) {
  const SensorType& type = *find_sensor_type(sensors::kLaser);
  const SensorSpec row = row_of_elements(700, 100.0);
  const std::vector<double> ranges(700, 5.0);
  base::ReadingBlock block;
  block.values = ranges;
  base::Bytes bytes;
  const std::uint8_t packet_type = type.encode(row, block, WireFormat::farm, 1, bytes);
  std::vector<double> read(700, kNaN);
  type.read(row, bytes, packet_type, WireFormat::farm, read);
  for (std::size_t i = 0; i < 700; ++i) EXPECT_EQ(std::isnan(read[i]), i < 310 || i >= 620) << i;
}

TEST(ReadingBack, NoReturn) {
  EXPECT_EQ(back(sensors::kLaser, row_of_elements(1, 100.0), {kInf}, WireFormat::farm)[0], kInf)
      << "the extended form has a word for it";
  EXPECT_EQ(back(sensors::kLaser, row_of_elements(1, 8.0), {kInf}, WireFormat::farm)[0], kInf)
      << "farther than the laser sees";
  EXPECT_EQ(back(sensors::kLaser, row_of_elements(1, 8.0), {kInf}, WireFormat::thesis)[0], kInf);
  EXPECT_EQ(back(sensors::kLaser, row_of_elements(1, 65.535), {kInf}, WireFormat::farm)[0], 65.535)
      << "it may be a range";
  EXPECT_EQ(back(sensors::kLaser, row_of_elements(1), {kInf}, WireFormat::farm)[0], 65.535) << "the laser is unknown";
  EXPECT_EQ(back(sensors::kLaser, row_of_elements(1, 8.0), {8.0}, WireFormat::farm)[0], 8.0);
}

TEST(ReadingBack, LaneEdges) {
  const std::vector<double> seen = back(kLaneEdge, row_of_elements(1), {0.2504, 61, 12.4e-6, 1.5e-3}, WireFormat::farm);
  EXPECT_DOUBLE_EQ(seen[0], 0.250);
  EXPECT_EQ(seen[1], 61.0);
  EXPECT_DOUBLE_EQ(seen[2], 12e-6);
  EXPECT_DOUBLE_EQ(seen[3], 1.5e-3);
  EXPECT_DOUBLE_EQ(back(kLaneEdge, row_of_elements(1), {70.0, 2, 0, 0}, WireFormat::farm)[0], 65.534)
      << "a far edge is still in sight";
}

TEST(ReadingBack, NoLaneEdgeInSight) {
  const std::vector<double> none = back(kLaneEdge, row_of_elements(1), {kNaN, 1, kNaN, kNaN}, WireFormat::farm);
  EXPECT_TRUE(std::isnan(none[0]));
  EXPECT_EQ(none[1], 1.0);
  EXPECT_TRUE(std::isnan(none[2]));
  EXPECT_TRUE(std::isnan(none[3]));
}

TEST(ReadingBack, ThesisFormCarriesOnlyTheDistance) {
  const std::vector<double> read = back(kLaneEdge, row_of_elements(1), {0.25, 61, 12e-6, 1.5e-3}, WireFormat::thesis);
  EXPECT_DOUBLE_EQ(read[0], 0.25);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_TRUE(std::isnan(read[i])) << i;
  EXPECT_TRUE(std::isnan(back(kLaneEdge, row_of_elements(1), {kNaN, 0, 0, kNaN}, WireFormat::thesis)[0]));
}

TEST(ReadingBack, Magnetometers) {
  trial::Chance chance(3);
  for (const WireFormat wire : {WireFormat::farm, WireFormat::thesis})
    for (std::uint32_t count = 1; count <= kMostElements; ++count) {
      std::vector<double> values;
      for (std::uint32_t i = 0; i < 4 * count; ++i) values.push_back(chance.between(-1e-3, 1e-3));
      const std::vector<double> read = back(kMagnetometer, row_of_elements(count, 1e-3), values, wire);
      for (std::uint32_t i = 0; i < 4 * count; ++i) {
        if (wire == WireFormat::thesis && i % 4 != 0) {
          EXPECT_TRUE(std::isnan(read[i])) << "the thesis carries magnitudes alone";
        } else {
          EXPECT_NEAR(read[i], values[i], 0.500001e-8);
        }
      }
    }
}

}  // namespace
}  // namespace sf::sensors
