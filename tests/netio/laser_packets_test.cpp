#include "netio/laser_packets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "tests/netio/examples.h"

namespace sf::netio {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// What a receiver reads where the farm had `metres`.
double through_wire(double metres, double range_max) {
  base::Bytes bytes;
  EXPECT_TRUE(encode_laser(Wire::farm, {}, std::vector{metres}, range_max, 0, bytes));
  Packet packet;
  EXPECT_EQ(decode(bytes, packet), Reason::accepted);
  return range(std::get<LaserPart>(packet.body), 0);
}

TEST(LaserPackets, PlainRangesRoundAndSaturate) {
  const auto plain = [](double metres) { return through_wire(metres, 8.0); };
  EXPECT_EQ(plain(0.0), 0.0);
  EXPECT_EQ(plain(0.000499), 0.0);  // just below half a count
  EXPECT_EQ(plain(0.0005), 0.001);  // half a count rounds up
  EXPECT_EQ(plain(1.2344), 1.234);
  EXPECT_EQ(plain(65.534), 65.534);   // last count but one
  EXPECT_EQ(plain(65.535), 65.535);   // last count
  EXPECT_EQ(plain(65.536), 65.535);   // one past it: u16 would wrap to 0
  EXPECT_EQ(plain(131.072), 65.535);  // twice round
  EXPECT_EQ(plain(1e300), 65.535);    // past any integer
  EXPECT_EQ(plain(kInf), 65.535);     // no return
  EXPECT_EQ(plain(-0.001), 0.0);      // noise below zero
  EXPECT_EQ(plain(-1e300), 0.0);
  EXPECT_EQ(plain(-kInf), 0.0);
}

TEST(LaserPackets, ExtendedRangesRoundAndSaturate) {
  const auto extended = [](double metres) { return through_wire(metres, 80.0); };
  EXPECT_EQ(extended(0.0), 0.0);
  EXPECT_EQ(extended(0.00004), 0.0);
  EXPECT_EQ(extended(0.00006), 0.0001);
  EXPECT_EQ(extended(65.5361), 65.5361);          // past the plain form
  EXPECT_EQ(extended(429496.7294), 429496.7294);  // last count
  EXPECT_EQ(extended(429496.7295), 429496.7294);  // the reserved word is never a range
  EXPECT_EQ(extended(429496.7296), 429496.7294);  // u32 would wrap to 0
  EXPECT_EQ(extended(1e300), 429496.7294);
  EXPECT_EQ(extended(kInf), kInf);  // no return stays one
  EXPECT_EQ(extended(-kInf), 0.0);
}

TEST(LaserPackets, NanIsNeverSent) {
  base::Bytes bytes = {1, 2, 3};
  EXPECT_FALSE(encode_laser(Wire::farm, {}, std::vector{1.0, kNan}, 8.0, 0, bytes));
  EXPECT_TRUE(bytes.empty());
  EXPECT_FALSE(encode_laser(Wire::farm, {}, std::vector{1.0, kNan}, 80.0, 0, bytes));
  EXPECT_FALSE(encode_laser(Wire::thesis, {}, std::vector{kNan, 1.0}, 8.0, 0, bytes));
}

TEST(LaserPackets, TheFormFollowsFromTheSensor) {
  EXPECT_TRUE(fits_plain(361, 65.535));
  EXPECT_FALSE(fits_plain(362, 8.0));
  EXPECT_FALSE(fits_plain(1, 65.536));
  EXPECT_FALSE(fits_plain(1, kInf));
  EXPECT_EQ(laser_parts(Wire::farm, 361, 8.0), 1u);
  EXPECT_EQ(laser_parts(Wire::farm, 362, 8.0), 2u);
  EXPECT_EQ(laser_parts(Wire::farm, 340, 80.0), 1u);  // exactly one full part
  EXPECT_EQ(laser_parts(Wire::farm, 341, 80.0), 2u);
  EXPECT_EQ(laser_parts(Wire::farm, kExtendedRays, 80.0), 2942u);
}

TEST(LaserPackets, ScansOfAnySizeComeBackWhole) {
  for (const std::uint32_t samples : {1u, 2u, 339u, 340u, 341u, 361u, 362u, 680u, 681u, 10'000u, kExtendedRays}) {
    for (const double range_max : {8.0, 100.0}) {
      std::vector<double> sent(samples);
      for (std::uint32_t i = 0; i < samples; ++i) sent[i] = (i * 7919 % 7000) * 1e-3;
      std::vector<double> got;
      base::Bytes bytes;
      const std::uint32_t parts = laser_parts(Wire::farm, samples, range_max);
      for (std::uint32_t part = 0; part < parts; ++part) {
        ASSERT_TRUE(encode_laser(Wire::farm, {.sequence = 5}, sent, range_max, part, bytes));
        ASSERT_LE(bytes.size(), kMaxDatagram);
        Packet packet;
        ASSERT_EQ(decode(bytes, packet), Reason::accepted) << samples << " part " << part;
        const auto& scan = std::get<LaserPart>(packet.body);
        ASSERT_EQ(scan.total, samples);
        ASSERT_EQ(scan.first, got.size());
        ASSERT_EQ(scan.parts, parts);
        for (std::uint32_t i = 0; i < scan.count; ++i) got.push_back(range(scan, i));
      }
      ASSERT_EQ(got.size(), sent.size());
      for (std::uint32_t i = 0; i < samples; ++i) ASSERT_NEAR(got[i], sent[i], 1e-9);
    }
  }
}

TEST(LaserPackets, LargestDatagramsAreTheDocumentedOnes) {
  base::Bytes bytes;
  ASSERT_TRUE(encode_laser(Wire::farm, {}, std::vector<double>(361, 1.0), 8.0, 0, bytes));
  EXPECT_EQ(bytes.size(), 748u);
  ASSERT_TRUE(encode_laser(Wire::thesis, {}, std::vector<double>(361, 1.0), 8.0, 0, bytes));
  EXPECT_EQ(bytes.size(), 724u);
  ASSERT_TRUE(encode_laser(Wire::farm, {}, std::vector<double>(340, 1.0), 80.0, 0, bytes));
  EXPECT_EQ(bytes.size(), 1400u);
}

TEST(LaserPackets, CountsThatDoNotFitAreRefused) {
  const auto reason_of = [](const base::Bytes& bytes) {
    Packet packet;
    return decode(bytes, packet);
  };
  base::Bytes none = patched<std::uint16_t>(laser_example(), 24, 0);
  none.resize(26);
  EXPECT_EQ(reason_of(none), Reason::out_of_range);  // a scan without rays
  base::Bytes many = patched<std::uint16_t>(laser_example(), 24, 362);
  many.resize(26 + 2 * 362);
  EXPECT_EQ(reason_of(many), Reason::out_of_range);                                         // one ray too many
  EXPECT_EQ(reason_of(patched<std::uint16_t>(laser_example(), 24, 4)), Reason::too_short);  // says more than it has
  EXPECT_EQ(reason_of(patched<std::uint16_t>(laser_example(), 24, 2)), Reason::too_long);   // says less
  EXPECT_EQ(reason_of(patched<std::uint16_t>(laser_example(), 24, 65535)), Reason::too_short);

  const base::Bytes part = laser_extended_example();
  EXPECT_EQ(reason_of(patched<std::uint32_t>(part, 24, 0)), Reason::out_of_range);                  // no rays
  EXPECT_EQ(reason_of(patched<std::uint32_t>(part, 24, kExtendedRays + 1)), Reason::out_of_range);  // too many
  EXPECT_EQ(reason_of(patched<std::uint32_t>(part, 24, 0xFFFFFFFF)), Reason::out_of_range);  // their sum would wrap
  EXPECT_EQ(reason_of(patched<std::uint32_t>(part, 24, 343)), Reason::out_of_range);         // one ray missing
  EXPECT_EQ(reason_of(patched<std::uint32_t>(part, 28, 341)), Reason::out_of_range);         // begins elsewhere
  EXPECT_EQ(reason_of(patched<std::uint16_t>(part, 32, 2)), Reason::out_of_range);           // part 2 of 2
  EXPECT_EQ(reason_of(patched<std::uint16_t>(part, 34, 3)), Reason::out_of_range);           // 3 parts for 342 rays
  EXPECT_EQ(reason_of(patched<std::uint16_t>(part, 36, 1)), Reason::too_long);
  EXPECT_EQ(reason_of(patched<std::uint16_t>(part, 36, 3)), Reason::too_short);
  EXPECT_EQ(reason_of(patched<std::uint16_t>(part, 38, 9)), Reason::accepted);  // reserved: ignored
}

TEST(LaserPackets, TheThesisLayoutIsTheBarePayload) {
  const base::Bytes bytes = thesis_example();
  LaserPart scan;
  ASSERT_EQ(read_laser(bytes, scan), Reason::accepted);
  ASSERT_EQ(scan.count, 3u);
  EXPECT_EQ(range(scan, 1), 0.25);
  const base::Bytes whole = laser_example();
  EXPECT_EQ(bytes, base::Bytes(whole.begin() + kHeaderBytes, whole.end()));
}

TEST(LaserPackets, SensorsThatAWireCannotCarryAreRefusedAtLoad) {
  EXPECT_NO_THROW(require_wire(Wire::thesis, 361, 65.535, "laser 0"));
  EXPECT_NO_THROW(require_wire(Wire::farm, kExtendedRays, 1e5, "laser 0"));
  EXPECT_THROW(require_wire(Wire::thesis, 362, 8.0, "laser 0"), base::InputError);
  EXPECT_THROW(require_wire(Wire::thesis, 1, 65.6, "laser 0"), base::InputError);
  EXPECT_THROW(require_wire(Wire::farm, kExtendedRays + 1, 8.0, "laser 0"), base::InputError);
}

}  // namespace
}  // namespace sf::netio
