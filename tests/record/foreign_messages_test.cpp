// Messages of other programs as numbers.

#include "record/foreign_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "record/cdr.h"
#include "record/ros_messages.h"
#include "record/schemas.h"

namespace sf::record {
namespace {

constexpr std::int64_t kTime = 1'300'000'000'000'000'123;

base::Bytes message(const std::function<void(CdrWriter&)>& fields) {
  base::Bytes bytes;
  CdrWriter cdr(bytes);
  put_header(cdr, kTime, "frame");
  fields(cdr);
  return bytes;
}

void put_counted(CdrWriter& cdr, int count) {
  for (int k = 0; k < count; ++k) cdr.put(k + 1.0);
}

base::Bytes fix(std::int8_t status, std::uint8_t covariance_type) {
  return message([&](CdrWriter& cdr) {
    cdr.put(status);
    cdr.put(std::uint16_t{1});
    put_counted(cdr, 3 + 9);
    cdr.put(covariance_type);
  });
}

base::Bytes imu() {
  return message([](CdrWriter& cdr) { put_counted(cdr, 4 + 9 + 3 + 9 + 3 + 9); });
}

base::Bytes odometry(double yaw, double tilt) {
  return message([&](CdrWriter& cdr) {
    cdr.put("base_link");
    for (const double position : {1.0, 2.0, 3.0}) cdr.put(position);
    // The yaw of a tilted body: a turn about x, then one about z.
    for (const double part : {std::cos(yaw / 2) * std::sin(tilt / 2), std::sin(yaw / 2) * std::sin(tilt / 2),
                              std::sin(yaw / 2) * std::cos(tilt / 2), std::cos(yaw / 2) * std::cos(tilt / 2)})
      cdr.put(part);
    put_counted(cdr, 36 + 6 + 36);
  });
}

base::Bytes scan() {
  base::Bytes bytes;
  encode_scan({.time = kTime, .frame = "laser", .fov = 2.0F, .range_min = 0.25, .range_max = 8.0},
              std::vector<double>{1, 2, 9}, bytes);
  return bytes;
}

ForeignMessage decoded(std::string_view type, const base::Bytes& bytes) {
  ForeignMessage message;
  EXPECT_TRUE(decode_foreign(type, bytes, message)) << type;
  EXPECT_EQ(message.time, kTime);
  if (type != kLaserScan) {
    EXPECT_EQ(message.values.size(), foreign_columns(type).size());
  }
  return message;
}

TEST(ForeignMessages, HaveTheirFieldsInOrder) {
  EXPECT_EQ(decoded(kImu, imu()).values, (std::vector<double>{16, 26, 27, 28}));
  const ForeignMessage pose = decoded(kOdometry, odometry(0.5, 0.25));
  EXPECT_NEAR(pose.values[2], 0.5, 1e-12);
  EXPECT_EQ(std::vector(pose.values.begin() + 3, pose.values.end()),
            (std::vector<double>{1, 1, 2, 6, 8, 12, 36, 37, 38, 42}));
  EXPECT_EQ(decoded(kNavSatFix, fix(0, 2)).values, (std::vector<double>{1, 2, 4 + 8}));
  const ForeignMessage ranges = decoded(kLaserScan, scan());
  EXPECT_EQ(ranges.angle_min, -1.0);
  EXPECT_EQ(ranges.angle_max, 1.0);
  EXPECT_EQ(ranges.values, (std::vector<double>{1, 2, HUGE_VAL}));
}

TEST(ForeignMessages, UnknownQuantitiesAreNaN) {
  const ForeignMessage none = decoded(kNavSatFix, fix(-1, 0));
  for (const double value : none.values) EXPECT_TRUE(std::isnan(value));
  base::Bytes bytes;
  encode_odometry({kTime, "odom", "base", {}}, {}, {}, bytes);
  EXPECT_TRUE(std::isnan(decoded(kOdometry, bytes).values[4])) << "a covariance of zeros";
}

TEST(ForeignMessages, CutBytesAreMalformed) {
  ForeignMessage into;
  for (const auto& [type, bytes] :
       {std::pair{kImu, imu()}, {kOdometry, odometry(0, 0)}, {kNavSatFix, fix(0, 1)}, {kLaserScan, scan()}})
    for (std::size_t size = 0; size < bytes.size(); ++size)
      ASSERT_FALSE(decode_foreign(type, std::span(bytes).first(size), into)) << type << " " << size;
  base::Bytes big = imu();
  big[1] = 0;  // big endian
  EXPECT_FALSE(decode_foreign(kImu, big, into));
  EXPECT_FALSE(decode_foreign(kClock, imu(), into));
  EXPECT_TRUE(foreign_columns(kClock).empty());
}

}  // namespace
}  // namespace sf::record
