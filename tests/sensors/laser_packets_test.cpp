#include "sensors/laser_packets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/netio/documented.h"
#include "tests/units.h"

namespace sf::sensors {
namespace {

using test::documented;

constexpr std::uint8_t kPlain = 1;
constexpr std::uint8_t kExtendedType = 65;
constexpr std::size_t kHeader = 64;     ///< [bytes] before every payload on the wire
constexpr std::size_t kSignature = 80;  ///< [bytes] after every payload

SensorSpec laser(std::uint32_t samples, double range_max) {
  SensorSpec row;
  row.elements = samples;
  row.limit = range_max;
  return row;
}

base::ReadingBlock scan_of(const std::vector<double>& ranges) { return {.type = 1, .values = ranges}; }

base::Bytes encoded(const std::vector<double>& ranges, double range_max, std::uint32_t part = 0,
                    WireFormat wire = WireFormat::farm) {
  base::Bytes out;
  encode_laser(laser(static_cast<std::uint32_t>(ranges.size()), range_max), scan_of(ranges), wire, part, out);
  return out;
}

base::Bytes payload_of(const base::Bytes& packet) { return {packet.begin() + kHeader, packet.end()}; }

template <class T>
base::Bytes patched(base::Bytes bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
  return bytes;
}

/// Returns the value that a receiver decodes for `metres`.
double through_wire(double metres, double range_max) {
  const base::Bytes bytes = encoded({metres}, range_max);
  LaserPart scan;
  EXPECT_EQ(read_laser(bytes, range_max > kPlainRange, scan), PayloadError::none);
  return range_of(scan, 0);
}

TEST(LaserPackets, PayloadsMatchTheDocumentation) {
  std::vector<double> parts(312, 1.0);
  parts[310] = 81.9175;
  parts[311] = kInf;
  EXPECT_EQ(encoded({1.0, 0.25, 8.0}, 8.0), payload_of(documented("laser")));
  EXPECT_EQ(encoded(parts, 100.0, 1), payload_of(documented("laser_extended")));
  EXPECT_EQ(encoded({1.0, 0.25, 8.0}, 8.0, 0, WireFormat::thesis), documented("thesis"));
  EXPECT_EQ(documented("laser").at(5), kPlain);
  EXPECT_EQ(documented("laser_extended").at(5), kExtendedType);
}

TEST(LaserPackets, PlainRangesRoundAndSaturate) {
  const auto plain = [](double metres) { return through_wire(metres, 8.0); };
  EXPECT_EQ(plain(0.0), 0.0);
  EXPECT_EQ(plain(0.000499), 0.0);  // just below half a unit
  EXPECT_EQ(plain(0.0005), 0.001);  // half a unit rounds up
  EXPECT_EQ(plain(1.2344), 1.234);
  EXPECT_EQ(plain(65.534), 65.534);   // second to last unit
  EXPECT_EQ(plain(65.535), 65.535);   // last unit
  EXPECT_EQ(plain(65.536), 65.535);   // one past it: u16 would wrap to 0
  EXPECT_EQ(plain(131.072), 65.535);  // would wrap twice
  EXPECT_EQ(plain(1e300), 65.535);    // beyond any integer
  EXPECT_EQ(plain(kInf), 65.535);     // no return
  EXPECT_EQ(plain(-0.001), 0.0);      // noise below zero
  EXPECT_EQ(plain(-1e300), 0.0);
  EXPECT_EQ(plain(-kInf), 0.0);
  for (std::uint32_t word = 0; word <= 0xFFFF; ++word) EXPECT_EQ(plain(word / 1e3), word / 1e3);
}

TEST(LaserPackets, ExtendedRangesRoundAndSaturate) {
  const auto extended = [](double metres) { return through_wire(metres, 80.0); };
  EXPECT_EQ(extended(0.0), 0.0);
  EXPECT_EQ(extended(0.00004), 0.0);
  EXPECT_EQ(extended(0.00006), 0.0001);
  EXPECT_EQ(extended(65.5361), 65.5361);          // past the plain form
  EXPECT_EQ(extended(429496.7294), 429496.7294);  // second to last word
  EXPECT_EQ(extended(429496.7295), 429496.7294);  // the reserved word is never a range
  EXPECT_EQ(extended(429496.7296), 429496.7294);  // u32 would wrap to 0
  EXPECT_EQ(extended(1e300), 429496.7294);
  EXPECT_EQ(extended(kInf), kInf);  // stays no return
  EXPECT_EQ(extended(-kInf), 0.0);
}

TEST(LaserPackets, NanIsNeverSent) {
  for (const double range_max : {8.0, 80.0}) {
    for (const auto& ranges : {std::vector{1.0, kNaN}, std::vector{kNaN, 1.0}}) {
      base::Bytes out = {1, 2, 3};
      EXPECT_EQ(encode_laser(laser(2, range_max), scan_of(ranges), WireFormat::farm, 0, out), 0);
      EXPECT_EQ(out, (base::Bytes{1, 2, 3}));  // nothing appended
    }
  }
  base::Bytes out;
  EXPECT_EQ(encode_laser(laser(1, 8.0), scan_of({kNaN}), WireFormat::thesis, 0, out), 0);
}

TEST(LaserPackets, NanOnlyStopsItsOwnPart) {
  std::vector<double> ranges(311, 1.0);
  ranges[310] = kNaN;
  base::Bytes out;
  EXPECT_EQ(encode_laser(laser(311, 80.0), scan_of(ranges), WireFormat::farm, 0, out), kExtendedType);
  EXPECT_EQ(encode_laser(laser(311, 80.0), scan_of(ranges), WireFormat::farm, 1, out), 0);
}

TEST(LaserPackets, PayloadsAreAppended) {
  base::Bytes out = {9};
  EXPECT_EQ(encode_laser(laser(1, 8.0), scan_of({1.0}), WireFormat::farm, 0, out), kPlain);
  EXPECT_EQ(out, (base::Bytes{9, 1, 0, 0xe8, 3}));
}

TEST(LaserPackets, SensorDeterminesTheForm) {
  const auto type = [](std::uint32_t samples, double range_max) {
    base::Bytes out;
    const std::vector<double> ranges(samples, 1.0);
    return encode_laser(laser(samples, range_max), scan_of(ranges), WireFormat::farm, 0, out);
  };
  EXPECT_EQ(type(361, 65.535), kPlain);
  EXPECT_EQ(type(362, 8.0), kExtendedType);
  EXPECT_EQ(type(1, 65.536), kExtendedType);
  EXPECT_EQ(type(1, kInf), kExtendedType);
  EXPECT_EQ(laser_parts(laser(361, 8.0), WireFormat::farm), 1u);
  EXPECT_EQ(laser_parts(laser(362, 8.0), WireFormat::farm), 2u);
  EXPECT_EQ(laser_parts(laser(310, 80.0), WireFormat::farm), 1u);  // exactly one full part
  EXPECT_EQ(laser_parts(laser(311, 80.0), WireFormat::farm), 2u);
  EXPECT_EQ(laser_parts(laser(kExtendedRays, 80.0), WireFormat::farm), 3226u);
}

TEST(LaserPackets, ScansOfAnySizeRoundTrip) {
  for (const std::uint32_t samples : {1u, 2u, 309u, 310u, 311u, 361u, 362u, 620u, 621u, 10'000u, kExtendedRays}) {
    for (const double range_max : {8.0, 100.0}) {
      const SensorSpec row = laser(samples, range_max);
      std::vector<double> sent(samples);
      for (std::uint32_t i = 0; i < samples; ++i) sent[i] = (i * 7919 % 7000) * 1e-3;
      std::vector<double> got;
      const std::uint32_t parts = laser_parts(row, WireFormat::farm);
      for (std::uint32_t part = 0; part < parts; ++part) {
        base::Bytes bytes;
        const std::uint8_t type = encode_laser(row, scan_of(sent), WireFormat::farm, part, bytes);
        ASSERT_LE(kHeader + bytes.size() + kSignature, 1400u);
        LaserPart scan;
        ASSERT_EQ(read_laser(bytes, type == kExtendedType, scan), PayloadError::none) << samples << " part " << part;
        ASSERT_EQ(scan.total, samples);
        ASSERT_EQ(scan.first, got.size());
        ASSERT_EQ(scan.parts, parts);
        const PayloadPart judged = decode_laser(row, bytes, type, WireFormat::farm);
        ASSERT_EQ(judged.fault, PayloadError::none);
        ASSERT_EQ(judged.elements, scan.count);
        ASSERT_EQ(judged.part, part);
        ASSERT_EQ(judged.parts, parts);
        for (std::uint32_t i = 0; i < scan.count; ++i) got.push_back(range_of(scan, i));
      }
      ASSERT_EQ(got.size(), sent.size());
      for (std::uint32_t i = 0; i < samples; ++i) ASSERT_NEAR(got[i], sent[i], 1e-9);
    }
  }
}

TEST(LaserPackets, LargestPayloadsMatchTheDocumentation) {
  EXPECT_EQ(kHeader + encoded(std::vector<double>(361, 1.0), 8.0).size(), 788u);
  EXPECT_EQ(encoded(std::vector<double>(361, 1.0), 8.0, 0, WireFormat::thesis).size(), 724u);
  EXPECT_EQ(kHeader + encoded(std::vector<double>(310, 1.0), 80.0).size() + kSignature, 1400u);
}

TEST(LaserPackets, RejectsInconsistentCounts) {
  const auto plain = [](const base::Bytes& payload) {
    LaserPart scan;
    return read_laser(payload, false, scan);
  };
  const base::Bytes three = payload_of(documented("laser"));
  EXPECT_EQ(plain(three), PayloadError::none);
  EXPECT_EQ(plain({0, 0}), PayloadError::out_of_range);  // a scan without rays
  base::Bytes many = patched<std::uint16_t>(three, 0, 362);
  many.resize(2 + 2 * 362);
  EXPECT_EQ(plain(many), PayloadError::out_of_range);                              // one ray too many
  EXPECT_EQ(plain(patched<std::uint16_t>(three, 0, 4)), PayloadError::too_short);  // count above the payload
  EXPECT_EQ(plain(patched<std::uint16_t>(three, 0, 2)), PayloadError::too_long);   // count below the payload
  EXPECT_EQ(plain(patched<std::uint16_t>(three, 0, 65535)), PayloadError::too_short);

  const auto extended = [](const base::Bytes& payload) {
    LaserPart scan;
    return read_laser(payload, true, scan);
  };
  const base::Bytes part = payload_of(documented("laser_extended"));
  EXPECT_EQ(extended(part), PayloadError::none);
  EXPECT_EQ(extended(patched<std::uint32_t>(part, 0, 0)), PayloadError::out_of_range);                  // no rays
  EXPECT_EQ(extended(patched<std::uint32_t>(part, 0, kExtendedRays + 1)), PayloadError::out_of_range);  // too many
  EXPECT_EQ(extended(patched<std::uint32_t>(part, 0, 0xFFFFFFFF)), PayloadError::out_of_range);  // their sum would wrap
  EXPECT_EQ(extended(patched<std::uint32_t>(part, 0, 313)), PayloadError::out_of_range);         // one ray missing
  EXPECT_EQ(extended(patched<std::uint32_t>(part, 4, 311)), PayloadError::out_of_range);         // wrong first ray
  EXPECT_EQ(extended(patched<std::uint16_t>(part, 8, 2)), PayloadError::out_of_range);           // part 2 of 2
  base::Bytes behind =
      patched<std::uint32_t>(patched<std::uint16_t>(patched<std::uint16_t>(part, 8, 2), 12, 310), 4, 620);
  behind.resize(16 + 4 * 310);
  EXPECT_EQ(extended(behind), PayloadError::out_of_range);  // otherwise consistent: the remainder would wrap
  EXPECT_EQ(extended(patched<std::uint16_t>(part, 10, 3)), PayloadError::out_of_range);  // 3 parts for 312 rays
  EXPECT_EQ(extended(patched<std::uint16_t>(part, 12, 1)), PayloadError::too_long);
  EXPECT_EQ(extended(patched<std::uint16_t>(part, 12, 3)), PayloadError::too_short);
  EXPECT_EQ(extended(patched<std::uint16_t>(part, 14, 9)), PayloadError::none);  // reserved: ignored
}

TEST(LaserPackets, PrefixesAreTooShortAndOneMoreByteIsTooLong) {
  for (const bool extended : {false, true}) {
    base::Bytes whole = payload_of(documented(extended ? "laser_extended" : "laser"));
    LaserPart scan;
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_EQ(read_laser(std::span(whole).first(size), extended, scan), PayloadError::too_short) << size;
    whole.push_back(0);
    EXPECT_EQ(read_laser(whole, extended, scan), PayloadError::too_long);
  }
}

TEST(LaserPackets, ValidatesScansAgainstTheSensor) {
  const auto judged = [](const std::vector<double>& ranges, double said, const SensorSpec& row) {
    const base::Bytes bytes = encoded(ranges, said);
    const std::uint8_t type = said > kPlainRange ? kExtendedType : kPlain;
    return decode_laser(row, bytes, type, WireFormat::farm).fault;
  };
  EXPECT_EQ(judged({0, 8, 8.001}, 8.0, laser(3, 8.0)), PayloadError::none);          // rounding may add one unit
  EXPECT_EQ(judged({0, 8, kInf}, 8.0, laser(3, 8.0)), PayloadError::none);           // saturated: no return
  EXPECT_EQ(judged({0, 8, 8.002}, 8.0, laser(3, 8.0)), PayloadError::out_of_range);  // beyond range_max
  EXPECT_EQ(judged({0, 8}, 8.0, laser(3, 8.0)), PayloadError::out_of_range);         // a ray is missing
  EXPECT_EQ(judged({99, kInf, 100.001}, 100.0, laser(3, 100.0)), PayloadError::none);
  EXPECT_EQ(judged({99, kInf, 100.002}, 100.0, laser(3, 100.0)), PayloadError::out_of_range);
  EXPECT_EQ(judged({429'496}, 100.0, laser(0, 0.0)), PayloadError::none);  // no checks for this spec
}

TEST(LaserPackets, RejectsOtherTypes) {
  const base::Bytes bytes = encoded({1.0}, 8.0);
  for (const int type : {0, 2, 64, 66, 128})
    EXPECT_EQ(decode_laser(laser(1, 8.0), bytes, static_cast<std::uint8_t>(type), WireFormat::farm).fault,
              PayloadError::out_of_range);
}

TEST(LaserPackets, RejectsSensorsThatTheWireCannotCarryAtLoad) {
  EXPECT_EQ(laser_wire_problem(laser(361, 65.535), WireFormat::thesis), "");
  EXPECT_EQ(laser_wire_problem(laser(kExtendedRays, 1e5), WireFormat::farm), "");
  EXPECT_NE(laser_wire_problem(laser(362, 8.0), WireFormat::thesis).find("362 samples up to 8"), std::string::npos);
  EXPECT_NE(laser_wire_problem(laser(1, 65.6), WireFormat::thesis).find("--wire farm"), std::string::npos);
  EXPECT_NE(laser_wire_problem(laser(kExtendedRays + 1, 8.0), WireFormat::farm).find("lower `samples`"),
            std::string::npos);
}

TEST(LaserPackets, InvalidLocalScansAbort) {
  base::Bytes out;
  const std::vector<double> three(3, 1.0);
  EXPECT_DEATH(encode_laser(laser(4, 8.0), scan_of(three), WireFormat::farm, 0, out), "3 rays, of 4 samples");
  EXPECT_DEATH(encode_laser(laser(3, 8.0), scan_of(three), WireFormat::farm, 1, out), "part 1");
  EXPECT_DEATH(encode_laser(laser(3, 99.0), scan_of(three), WireFormat::thesis, 0, out), "in the thesis' layout");
}

TEST(LaserPackets, ValidatesAnyBytes) {
  std::mt19937 random(20260102);  // NOLINT: the same payloads in every run
  const SensorSpec rows[] = {laser(3, 8.0), laser(312, 100.0), laser(0, 0.0)};
  const base::Bytes seeds[] = {payload_of(documented("laser")), payload_of(documented("laser_extended"))};
  std::uint64_t good = 0;
  for (int i = 0; i < 200'000; ++i) {
    const bool extended = random() % 2 == 0;
    base::Bytes bytes = seeds[extended ? 1 : 0];
    for (std::uint32_t edits = random() % 4; edits > 0; --edits)
      bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    if (random() % 8 == 0) bytes.resize(random() % 60);
    LaserPart scan;
    if (read_laser(bytes, extended, scan) == PayloadError::none) {
      ASSERT_LE(std::uint64_t{scan.first} + scan.count, scan.total);
      ASSERT_LT(scan.part, scan.parts);
      for (std::uint32_t ray = 0; ray < scan.count; ++ray) ASSERT_GE(range_of(scan, ray), 0.0);
    }
    for (const SensorSpec& row : rows)
      good += decode_laser(row, bytes, extended ? kExtendedType : kPlain, WireFormat::farm).fault == PayloadError::none;
  }
  EXPECT_GT(good, 10'000u);
  EXPECT_LT(good, 590'000u);
}

}  // namespace
}  // namespace sf::sensors
