#include "record/reading_messages.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "tests/record/bytes_at.h"
#include "tests/record/sample.h"

namespace sf::record {
namespace {

using base::Bytes;
using test::array_type;
using test::at;
using test::edge_type;

Bytes encoded(const SensorTypeInfo& type, const std::vector<double>& values) {
  Bytes out;
  encode_reading(type, 12'000'000'034, "r/s", values, out);
  return out;
}

TEST(Readings, EachTypeHasItsOwnMessageType) {
  EXPECT_EQ(type_of(edge_type()), "sensorfarm_msgs/msg/Edge");
  const std::string text = schema_text(edge_type());
  EXPECT_EQ(text.rfind("std_msgs/Header header\nfloat64 distance_m\nuint32 points\nfloat64[3] normal_w\n=", 0), 0u)
      << text;
  EXPECT_NE(text.find("MSG: builtin_interfaces/Time\n"), std::string::npos);
}

TEST(Readings, TypeWithAListHasAnArrayPerColumn) {
  const std::string text = schema_text(array_type());
  EXPECT_EQ(text.rfind("std_msgs/Header header\nfloat64[] field_t\nfloat64[] vector_t\nuint32[] hits\n=", 0), 0u)
      << text;
}

TEST(Readings, SingleRowMatchesItsDefinition) {
  const Bytes out = encoded(edge_type(), {0.25, 61.0, 1.0, 2.0, 3.0});
  EXPECT_EQ(at<std::int32_t>(out, 4), 12);
  EXPECT_EQ(at<std::uint32_t>(out, 8), 34u);
  EXPECT_EQ(std::memcmp(out.data() + 16, "r/s", 4), 0);
  EXPECT_EQ(at<double>(out, 20), 0.25);        // 16 after the encapsulation
  EXPECT_EQ(at<std::uint32_t>(out, 28), 61u);  // then 4 of padding
  EXPECT_EQ(at<double>(out, 36), 1.0);
  EXPECT_EQ(at<double>(out, 52), 3.0);
  EXPECT_EQ(out.size(), 60u);
}

TEST(Readings, ListIsStoredColumnByColumn) {
  const Bytes out = encoded(array_type(), {1.5, 1, 2, 3, 7, 2.5, 4, 5, 6, 8});
  EXPECT_EQ(at<std::uint32_t>(out, 20), 2u);  // field_t: 16 after the encapsulation, then 4 of padding
  EXPECT_EQ(at<double>(out, 28), 1.5);
  EXPECT_EQ(at<double>(out, 36), 2.5);
  EXPECT_EQ(at<std::uint32_t>(out, 44), 6u);  // vector_t: two of three
  EXPECT_EQ(at<double>(out, 52), 1.0);
  EXPECT_EQ(at<double>(out, 92), 6.0);
  EXPECT_EQ(at<std::uint32_t>(out, 100), 2u);  // hits
  EXPECT_EQ(at<std::uint32_t>(out, 104), 7u);
  EXPECT_EQ(at<std::uint32_t>(out, 108), 8u);
  EXPECT_EQ(out.size(), 112u);
}

TEST(Readings, ReadingsOfAnyShapeRoundTripBitwise) {
  std::mt19937 random(3);  // NOLINT: the same shapes every time
  for (int i = 0; i < 2000; ++i) {
    SensorTypeInfo type{.id = 9, .name = "any", .list = random() % 2 == 0 ? "rows" : ""};
    for (std::uint32_t c = 1 + random() % 4; c > 0; --c)
      type.columns.push_back(
          {"c" + std::to_string(c), 1 + static_cast<std::uint32_t>(random() % 4), random() % 3 == 0});
    const std::size_t elements = type.list.empty() ? 1 : random() % 5;
    std::vector<double> sent;
    for (std::size_t e = 0; e < elements; ++e)
      for (const ColumnInfo& column : type.columns)
        for (std::uint32_t k = 0; k < column.width; ++k)
          sent.push_back(column.whole ? static_cast<double>(random()) : static_cast<double>(random()) / 7.0 - 1e8);
    std::vector<double> got{99.0};
    std::int64_t time = 0;
    ASSERT_TRUE(decode_reading(type, encoded(type, sent), time, got)) << i;
    EXPECT_EQ(time, 12'000'000'034);
    ASSERT_EQ(got, sent) << i;
  }
}

TEST(Readings, MissingValuesStayNotANumber) {
  std::vector<double> got;
  std::int64_t time = 0;
  ASSERT_TRUE(decode_reading(edge_type(), encoded(edge_type(), {std::nan(""), 0, 0, 0, 0}), time, got));
  EXPECT_TRUE(std::isnan(got[0]));
}

TEST(Readings, CountsSaturate) {
  const auto count = [](double value) { return at<std::uint32_t>(encoded(edge_type(), {0, value, 0, 0, 0}), 28); };
  EXPECT_EQ(count(-1.0), 0u);
  EXPECT_EQ(count(std::nan("")), 0u);
  EXPECT_EQ(count(1.0), 1u);
  EXPECT_EQ(count(4294967295.0), 4294967295u);  // the last
  EXPECT_EQ(count(4294967296.0), 4294967295u);  // one more: u32 would wrap to 0
  EXPECT_EQ(count(std::numeric_limits<double>::infinity()), 4294967295u);
}

TEST(Readings, RejectsEveryTruncation) {
  std::vector<double> values;
  std::int64_t time = 0;
  for (const auto& [type, sent] : {std::pair{edge_type(), std::vector<double>{1, 2, 3, 4, 5}},
                                   std::pair{array_type(), std::vector<double>{1, 2, 3, 4, 5, 1, 2, 3, 4, 5}}}) {
    const Bytes whole = encoded(type, sent);
    for (std::size_t size = 0; size < whole.size(); ++size)
      EXPECT_FALSE(decode_reading(type, std::span(whole).first(size), time, values)) << type.name << " " << size;
  }
}

TEST(Readings, RejectsArraysOfDifferentLengths) {
  std::vector<double> values;
  std::int64_t time = 0;
  Bytes bytes = encoded(array_type(), {1.5, 1, 2, 3, 7, 2.5, 4, 5, 6, 8});
  bytes[44] = 5;  // vector_t: not two of three
  EXPECT_FALSE(decode_reading(array_type(), bytes, time, values));
  bytes[44] = 6;
  bytes[20] = 1;  // field_t: one element; the others have two
  EXPECT_FALSE(decode_reading(array_type(), bytes, time, values));
}

TEST(Readings, RejectsInvalidTypes) {
  std::vector<double> values;
  std::int64_t time = 0;
  const Bytes bytes = encoded(edge_type(), {1, 2, 3, 4, 5});
  SensorTypeInfo type{.id = 2, .name = "edge"};
  EXPECT_FALSE(decode_reading(type, bytes, time, values));  // empty
  type.columns = {{"a", 0}};
  EXPECT_FALSE(decode_reading(type, bytes, time, values));  // a column of width 0
  type.columns = {{"a", 0xFFFFFFFF}};
  EXPECT_FALSE(decode_reading(type, bytes, time, values));  // larger than memory
  type.columns = {{"a", 1}, {"b", 0xFFFFFFFF}};
  type.list = "rows";
  EXPECT_FALSE(decode_reading(type, encoded(array_type(), {1, 2, 3, 4, 5}), time, values));
}

TEST(Readings, BrokenPreconditionsAbortWithTheValues) {
  EXPECT_DEATH(encoded(edge_type(), {1, 2, 3, 4}), "4 values in a reading of type edge");
  EXPECT_DEATH(encoded(edge_type(), std::vector<double>(10)), "10 values");  // two rows without a list
  EXPECT_DEATH(encoded(array_type(), std::vector<double>(6)), "6 values in a reading of type array");
  EXPECT_DEATH(encoded({.id = 4, .name = "none"}, {}), "0 values");
}

/// A lidar reports as many columns as it was asked for: the arrays of the others are empty.
TEST(Readings, LastColumnsOfAListMayBeLeftOut) {
  const SensorTypeInfo type{44, "lidar", "beams", {{"range_m"}, {"intensity"}, {"vector_T", 3}}, false};
  for (const std::size_t width : {1u, 2u, 5u}) {
    std::vector<double> values(3 * width), got;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5 * static_cast<double>(i);
    Bytes bytes;
    encode_reading(type, 5, "f", values, bytes, width);
    std::int64_t time = 0;
    std::size_t read = 0;
    ASSERT_TRUE(decode_reading(type, bytes, time, got, &read));
    EXPECT_EQ(got, values);
    EXPECT_EQ(read, width);
  }
  Bytes gap;  // a column after one that is left out
  encode_reading({44, "lidar", "beams", {{"range_m"}, {"a"}, {"b"}}, false}, 5, "f", std::vector<double>{1, 2}, gap, 1);
  gap[gap.size() - 4] = 2, gap.resize(gap.size() + 20);
  std::int64_t time = 0;
  std::vector<double> got;
  EXPECT_FALSE(decode_reading({44, "lidar", "beams", {{"range_m"}, {"a"}, {"b"}}, false}, gap, time, got));
}

}  // namespace
}  // namespace sf::record
